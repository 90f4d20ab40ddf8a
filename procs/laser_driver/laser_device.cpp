// SPDX-License-Identifier: BSD-3-Clause
#include "laser_driver/laser_device.hpp"

#include <stdexcept>

#include "bus/node/process_report.hpp"
#include "device/emulated/emulated_laser.hpp"
#include "device/laser_protocol.hpp"

namespace orchard::procs {

bus::StreamDevice make_laser_device(const device::LaserDriverConfig& config, double plane_height_m,
                                    bus::Channel channel) {
  bus::StreamDevice laser;
  laser.device = config.device;
  laser.make_protocol = [config, plane_height_m] {
    return device::make_laser_protocol(config, plane_height_m);
  };
  laser.make_emulated = [config] {
    if (config.protocol == device::LaserProtocol::kVelodyne) {
      throw std::invalid_argument(
          "--emulate: a VLP-16 cannot be made of a log, which has no layers; play the log itself "
          "with orchard-log-player");
    }
    return device::make_emulated_laser(config.protocol, bus::wall_utime() - 60'000'000);
  };
  laser.emulated_at = "tcp:127.0.0.1:0";
  laser.channels = {channel};
  laser.is_rear = channel == bus::Channel::kScanRear;
  return laser;
}

}  // namespace orchard::procs
