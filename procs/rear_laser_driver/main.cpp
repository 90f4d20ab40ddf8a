// SPDX-License-Identifier: BSD-3-Clause
#include "bus/process/process.hpp"
#include "io/config/config.hpp"
#include "laser_driver/laser_device.hpp"

int main(int argc, char** argv) {
  using namespace orchard;
  bus::ProcessInfo info;
  info.name = "orchard-rear-laser-driver";
  info.description =
      "Read a second laser scanner and send SCAN.rear.\n"
      "Supports the scanners of orchard-laser-driver. The detector joins both scans "
      "(laser_rear.enabled).\n"
      "Configuration: drivers.laser_rear.";
  io::RigFile rig;
  return bus::run_stream_process(argc, argv, info, rig, [&rig] {
    return procs::make_laser_device(rig.config().drivers.laser_rear,
                                    rig.config().laser_rear.height_m, bus::Channel::kScanRear);
  });
}
