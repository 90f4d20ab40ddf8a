// SPDX-License-Identifier: BSD-3-Clause
#include "bus/node/process.hpp"
#include "camera_driver/camera_driver.hpp"

int main(int argc, char** argv) {
  using namespace orchard;
  procs::CameraDriverOptions options;
  bus::ProcessInfo info;
  info.name = "orchard-camera-driver";
  info.description =
      "Reads a camera (Video4Linux2), a folder of pictures or a video. Sends IMAGE: the camera's "
      "own\n"
      "JPEG where it has one, compressed only where drivers.camera.max_bytes asks for it.";
  info.options = {
      {"--device", "DEVICE", "/dev/video0, pictures:FOLDER or video:FILE", &options.device},
      {"--emulate", "LOG", "play the pictures of a log as a camera would give them",
       &options.emulate},
      {"--emulate-at", "UTIME",
       "play the log's first event, or the first picture, at that time of the host [us] [now]",
       &options.emulate_at},
  };
  io::RigFile rig;
  return bus::run_device_process(argc, argv, info, rig,
                                 [&] { return procs::make_camera_driver(options, rig.config()); });
}
