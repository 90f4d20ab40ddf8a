// SPDX-License-Identifier: BSD-3-Clause
#include "bus/process/process.hpp"
#include "io/config/config.hpp"
#include "odometry_driver/controller_device.hpp"

int main(int argc, char** argv) {
  using namespace orchard;
  bus::ProcessInfo info;
  info.name = "orchard-odometry-driver";
  info.description =
      "Read text lines of a robot's controller and send ODOMETRY.\n"
      "The lines have wheel velocities, wheel ticks or IMU data; of I lines IMU is sent, too.\n"
      "Configuration: drivers.odometry.";
  io::RigFile rig;
  return bus::run_stream_process(argc, argv, info, rig, [&rig] {
    const device::DriversConfig& drivers = rig.config().drivers;
    return procs::make_controller_device(drivers, drivers.odometry.device, bus::Channel::kOdometry);
  });
}
