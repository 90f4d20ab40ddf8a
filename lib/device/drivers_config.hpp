// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "device/bot_core_config.hpp"
#include "device/camera/camera_driver_config.hpp"
#include "device/gnss/gnss_driver_config.hpp"
#include "device/lines/odometry_driver_config.hpp"

namespace orchard::device {

/// Protocol of a laser scanner.
enum class LaserProtocol {
  kScip,   ///< Hokuyo: SCIP 2.0 and later
  kColaA,  ///< SICK TiM3xx, TiM5xx, LMS1xx: CoLa-A
};

/// The scanner of orchard-laser-driver. Section `drivers.laser`.
struct LaserDriverConfig {
  std::string device;
  LaserProtocol protocol = LaserProtocol::kScip;
};

template <class Visitor>
void describe(Visitor& v, LaserDriverConfig& c) {
  v.text("device", c.device,
         "address of the scanner: tcp:192.168.0.10:10940 or serial:/dev/ttyACM0:115200; empty = no "
         "scanner");
  v.choice("protocol", c.protocol, {"scip", "cola_a"},
           "protocol: scip for Hokuyo, cola_a for SICK");
}

/// Addresses and settings of this machine's sensors. Section `drivers`.
struct DriversConfig {
  LaserDriverConfig laser;
  LaserDriverConfig laser_rear;
  CameraDriverConfig camera;
  GnssDriverConfig gnss;
  OdometryDriverConfig odometry;
  ImuDriverConfig imu;
  BotCoreConfig bot_core;
};

template <class Visitor>
void describe(Visitor& v, DriversConfig& c) {
  v.section("laser", c.laser, "orchard-laser-driver");
  v.expert().section("laser_rear", c.laser_rear, "orchard-rear-laser-driver");
  v.section("camera", c.camera, "orchard-camera-driver");
  v.section("gnss", c.gnss, "orchard-gnss-driver");
  v.section("odometry", c.odometry, "orchard-odometry-driver");
  v.section("imu", c.imu, "orchard-imu-driver");
  v.expert().section("bot_core", c.bot_core, "orchard-bot-core-adapter");
}

}  // namespace orchard::device
