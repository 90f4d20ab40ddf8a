// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include "bus/driver/stream_process.hpp"
#include "device/lines/controller_protocol.hpp"
#include "io/config/config.hpp"
#include "simulation/device/controller_device.hpp"

int main(int argc, char** argv) {
  using namespace orchard;
  bus::ProcessInfo info;
  info.name = "orchard-odometry-driver";
  info.description =
      "Reads text lines of a robot's controller: wheel velocities, wheel ticks, an inertial unit.\n"
      "Sends ODOMETRY, and IMU where the controller sends I lines. Configuration: "
      "drivers.odometry.";
  io::RigFile rig;
  return bus::run_stream_process(argc, argv, info, rig, [&rig] {
    const device::DriversConfig& drivers = rig.config().drivers;
    bus::StreamDevice wheels;
    wheels.device = drivers.odometry.device;
    wheels.make_protocol = [drivers] {
      return std::make_unique<device::ControllerProtocol>(drivers.odometry, drivers.imu);
    };
    wheels.make_emulated = [] {
      return std::make_unique<simulation::ControllerDevice>(simulation::EmulatedClock{});
    };
    wheels.emulated_at = "pty:";
    wheels.channels = {bus::Channel::kOdometry};
    return wheels;
  });
}
