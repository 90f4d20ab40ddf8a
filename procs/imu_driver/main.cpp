// SPDX-License-Identifier: BSD-3-Clause
#include "bus/process/process.hpp"
#include "io/config/config.hpp"
#include "odometry_driver/controller_device.hpp"

int main(int argc, char** argv) {
  using namespace orchard;
  bus::ProcessInfo info;
  info.name = "orchard-imu-driver";
  info.description =
      "Read text lines of an IMU with its own serial line and send IMU.\n"
      "An IMU on the line of the wheel controller is read by orchard-odometry-driver.\n"
      "Configuration: drivers.imu.";
  io::RigFile rig;
  return bus::run_stream_process(argc, argv, info, rig, [&rig] {
    const device::DriversConfig& drivers = rig.config().drivers;
    return procs::make_controller_device(drivers, drivers.imu.device, bus::Channel::kImu);
  });
}
