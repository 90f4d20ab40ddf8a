// SPDX-License-Identifier: BSD-3-Clause
#include "bus/process/process.hpp"
#include "camera_driver/camera_driver.hpp"

int main(int argc, char** argv) {
  using namespace orchard;
  procs::CameraDriverOptions options;
  bus::ProcessInfo info;
  info.name = "orchard-camera-driver";
  info.description =
      "Read a camera (Video4Linux2), a folder of pictures or a video, and send IMAGE.\n"
      "A JPEG of the camera is passed on; it is compressed again only if it is larger than\n"
      "drivers.camera.max_bytes.";
  info.options = {
      {"--device", "DEVICE", "source: /dev/video0 or pictures:FOLDER [drivers.camera.device]",
       &options.device},
      {"--emulate", "LOG", "emulate the camera: replay the pictures of this log", &options.emulate},
      {"--emulate-at", "UTIME",
       "time of this machine at the first event of the log, or the first picture [us] [now]",
       &options.emulate_at},
  };
  io::RigFile rig;
  return bus::run_device_process(argc, argv, info, rig,
                                 [&] { return procs::make_camera_driver(options, rig.config()); });
}
