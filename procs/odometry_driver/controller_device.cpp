// SPDX-License-Identifier: BSD-3-Clause
#include "odometry_driver/controller_device.hpp"

#include <memory>

#include "device/emulated/emulated_lines.hpp"
#include "device/lines/controller_protocol.hpp"

namespace orchard::procs {

bus::StreamDevice make_controller_device(const device::DriversConfig& drivers,
                                         const std::string& address, bus::Channel channel) {
  bus::StreamDevice controller;
  controller.device = address;
  controller.make_protocol = [drivers] {
    return std::make_unique<device::ControllerProtocol>(drivers.odometry, drivers.imu);
  };
  controller.make_emulated = [] {
    return std::make_unique<device::ControllerDevice>(device::EmulatedClock{});
  };
  controller.emulated_at = "pty:";
  controller.channels = {channel};
  return controller;
}

}  // namespace orchard::procs
