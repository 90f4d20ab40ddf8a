// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include "bus/process/process.hpp"
#include "device/emulated/emulated_lines.hpp"
#include "device/gnss/gpsd_protocol.hpp"
#include "io/config/config.hpp"

int main(int argc, char** argv) {
  using namespace orchard;
  bus::ProcessInfo info;
  info.name = "orchard-gnss-driver";
  info.description =
      "Read a GNSS receiver through gpsd and send GNSS.\n"
      "GNSS has fixes with their quality (including RTK fixed and float) and covariance.\n"
      "Configuration: drivers.gnss.";
  io::RigFile rig;
  return bus::run_stream_process(argc, argv, info, rig, [&rig] {
    const device::GnssDriverConfig& config = rig.config().drivers.gnss;
    bus::StreamDevice receiver;
    receiver.device = config.device;
    receiver.make_protocol = [config] { return std::make_unique<device::GpsdProtocol>(config); };
    receiver.make_emulated = [config] {
      return std::make_unique<device::GpsdDevice>(config.latency_s);
    };
    receiver.emulated_at = "tcp:127.0.0.1:0";
    receiver.channels = {bus::Channel::kGnss};
    return receiver;
  });
}
