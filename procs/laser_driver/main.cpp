// SPDX-License-Identifier: BSD-3-Clause
#include "bus/process/process.hpp"
#include "io/config/config.hpp"
#include "laser_driver/laser_device.hpp"

int main(int argc, char** argv) {
  using namespace orchard;
  bus::ProcessInfo info;
  info.name = "orchard-laser-driver";
  info.description =
      "Read a laser scanner over TCP, UDP or a serial line and send SCAN.\n"
      "Supports Hokuyo (SCIP 2.0: URG-04LX-UG01, UTM-30LX, UST-10LX) and SICK (CoLa-A and "
      "CoLa-B:\n"
      "TiM3xx, TiM5xx, TiM7xx, LMS1xx, LMS5xx), and Velodyne's VLP-16, whose layers become one "
      "scan\n"
      "0.3 m above the ground. The time stamp is that of the first beam, by the clock of this "
      "machine.\n"
      "Configuration: drivers.laser.";
  io::RigFile rig;
  return bus::run_stream_process(argc, argv, info, rig, [&rig] {
    return procs::make_laser_device(rig.config().drivers.laser, rig.config().laser.height_m,
                                    bus::Channel::kScan);
  });
}
