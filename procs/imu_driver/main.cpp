// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include "bus/driver/stream_process.hpp"
#include "device/lines/controller_protocol.hpp"
#include "io/config/config.hpp"
#include "simulation/device/controller_device.hpp"

int main(int argc, char** argv) {
  using namespace orchard;
  bus::ProcessInfo info;
  info.name = "orchard-imu-driver";
  info.description =
      "Reads text lines of an inertial unit that has a line of its own; one that shares the "
      "wheels'\n"
      "line is read by orchard-odometry-driver. Sends IMU. Configuration: drivers.imu.";
  io::RigFile rig;
  return bus::run_stream_process(argc, argv, info, rig, [&rig] {
    const device::DriversConfig& drivers = rig.config().drivers;
    bus::StreamDevice unit;
    unit.device = drivers.imu.device;
    unit.make_protocol = [drivers] {
      return std::make_unique<device::ControllerProtocol>(drivers.odometry, drivers.imu);
    };
    unit.make_emulated = [] {
      return std::make_unique<simulation::ControllerDevice>(simulation::EmulatedClock{});
    };
    unit.emulated_at = "pty:";
    unit.channels = {bus::Channel::kImu};
    return unit;
  });
}
