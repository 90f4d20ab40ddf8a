// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include "bus/driver/stream_process.hpp"
#include "bus/node/process_report.hpp"
#include "device/laser_protocol.hpp"
#include "io/config/config.hpp"
#include "simulation/device/emulated_laser.hpp"

int main(int argc, char** argv) {
  using namespace orchard;
  bus::ProcessInfo info;
  info.name = "orchard-laser-driver";
  info.description =
      "Reads a laser scanner: Hokuyo (SCIP 2.0: URG-04LX-UG01, UTM-30LX, UST-10LX) or SICK\n"
      "(CoLa-A: TiM3xx, TiM5xx, LMS1xx), over TCP or a serial line. Sends SCAN, stamped with the\n"
      "host's time of its first beam. Configuration: drivers.laser.";
  io::RigFile rig;
  return bus::run_stream_process(argc, argv, info, rig, [&rig] {
    const device::LaserDriverConfig& config = rig.config().drivers.laser;
    bus::StreamDevice laser;
    laser.device = config.device;
    laser.make_protocol = [config] { return device::make_laser_protocol(config.protocol); };
    laser.make_emulated = [config] {
      return simulation::make_emulated_laser(config.protocol, bus::wall_utime() - 60'000'000);
    };
    laser.emulated_at = "tcp:127.0.0.1:0";
    laser.channels = {bus::Channel::kScan};
    return laser;
  });
}
