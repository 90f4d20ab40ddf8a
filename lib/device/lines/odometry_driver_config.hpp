// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>

namespace orchard::device {

/// The wheels' controller of orchard-odometry-driver. Section `drivers.odometry`.
struct OdometryDriverConfig {
  std::string device;
  /// What one tick of the left and of the right wheel is worth; negative for a wheel that counts
  /// backwards when the robot drives forward.
  std::array<double, 2> metres_per_tick{0.001, 0.001};
  double wheel_distance_m = 0.5;
  int counter_bits = 32;
};

template <class Visitor>
void describe(Visitor& v, OdometryDriverConfig& c) {
  v.text("device", c.device,
         "address of the controller: serial:/dev/ttyACM0:115200 or tcp:HOST:PORT; empty = none");
  v.numbers("metres_per_tick", c.metres_per_tick, -1, 1, "m",
            "T lines: distance per tick of the left and the right wheel; negative if a wheel "
            "counts backwards");
  v.number("wheel_distance_m", c.wheel_distance_m, 0.01, 10, "m",
           "T lines: distance between the tracks of the left and the right wheel");
  v.expert().integer("counter_bits", c.counter_bits, 8, 64, "1",
                     "T lines: size of the tick counters, which wrap at 2^counter_bits");
}

/// The inertial unit: of orchard-imu-driver, or on the same line as the wheels. Section
/// `drivers.imu`.
struct ImuDriverConfig {
  std::string device;
  std::array<double, 3> mount_rad{0.0, 0.0, 0.0};
};

template <class Visitor>
void describe(Visitor& v, ImuDriverConfig& c) {
  v.text("device", c.device,
         "address of an IMU with its own line: serial:/dev/ttyACM1:115200 or tcp:HOST:PORT; empty "
         "= none");
  v.numbers("mount_rad", c.mount_rad, -6.2832, 6.2832, "rad",
            "I lines: roll, pitch, yaw of the axes of the IMU in base");
}

}  // namespace orchard::device
