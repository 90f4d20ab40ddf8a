// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>

namespace orchard::device {

/// Conversion of libbot's pose_t.
enum class BotPoseAs {
  kOdometry,  ///< to velocities: for a drifting pose, as from wheels or an estimator without a map
  kPoseFix,   ///< to external positions: from motion capture, a total station or localisation in a
              ///< map
};

/// A robot that publishes libbot's types. Section `drivers.bot_core`.
struct BotCoreConfig {
  std::string lcm_url;
  std::string scan_channel;
  std::string image_channel;
  std::string pose_channel;
  std::string gps_channel;
  BotPoseAs pose_as = BotPoseAs::kOdometry;
  double range_min_m = 0.05;
  double range_max_m = 30.0;
};

template <class Visitor>
void describe(Visitor& v, BotCoreConfig& c) {
  v.text("lcm_url", c.lcm_url,
         "URL of the LCM network of a robot with libbot's types; empty = none");
  v.text("scan_channel", c.scan_channel, "channel of planar_lidar_t; empty = the first one found");
  v.text("image_channel", c.image_channel, "channel of image_t; empty = the first one found");
  v.text("pose_channel", c.pose_channel, "channel of pose_t; empty = the first one found");
  v.text("gps_channel", c.gps_channel, "channel of gps_data_t; empty = the first one found");
  v.choice("pose_as", c.pose_as, {"odometry", "pose_fix"},
           "pose_t is converted to: velocities (ODOMETRY) | external positions (POSE_FIX)");
  v.number("range_min_m", c.range_min_m, 0, 10, "m",
           "min range of the scanner, which planar_lidar_t does not state; from the data sheet");
  v.number("range_max_m", c.range_max_m, 0.1, 1000, "m",
           "max range of the scanner, which planar_lidar_t does not state; from the data sheet");
  v.check(c.range_min_m < c.range_max_m, "range_min_m", "must be below range_max_m");
}

/// The camera of orchard-camera-driver; section `camera` gives the size of its pictures. Section
/// `drivers.camera`.
struct CameraDriverConfig {
  std::string device;
  double rate_hz = 10.0;
  int max_bytes = 60000;
};

template <class Visitor>
void describe(Visitor& v, CameraDriverConfig& c) {
  v.text("device", c.device, "camera: /dev/video0 or pictures:FOLDER; empty = no camera");
  v.expert().number("rate_hz", c.rate_hz, 0.1, 120, "Hz", "max pictures per second");
  v.expert().integer(
      "max_bytes", c.max_bytes, 1000, 4000000, "bytes",
      "max size of a picture; larger ones are compressed again; above 60000 a picture needs "
      "several datagrams");
}

/// Source of a fix's time stamp.
enum class GnssStamp {
  kReceipt,  ///< its arrival, freed of jitter, minus latency_s
  kFixTime,  ///< its own time; correct where satellite time sets the host's clock (chrony with the
             ///< receiver)
};

/// The receiver of orchard-gnss-driver, read through gpsd. Section `drivers.gnss`.
struct GnssDriverConfig {
  std::string device;
  std::string receiver;
  GnssStamp stamp = GnssStamp::kReceipt;
  double latency_s = 0.1;
};

template <class Visitor>
void describe(Visitor& v, GnssDriverConfig& c) {
  v.text("device", c.device, "address of gpsd: tcp:127.0.0.1:2947; empty = no receiver");
  v.expert().text("receiver", c.receiver,
                  "name of the receiver in gpsd (/dev/ttyACM0); empty = the first that reports");
  v.expert().choice(
      "stamp", c.stamp, {"receipt", "fix_time"},
      "time stamp: arrival minus latency_s | time of the fix, if the clock of this machine is "
      "synchronised to satellite time");
  v.expert().number("latency_s", c.latency_s, 0, 2, "s",
                    "stamp: receipt: min delay from a fix to its arrival; from the data sheet");
}

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

/// Protocol of a laser scanner.
enum class LaserProtocol {
  kScip,      ///< Hokuyo: SCIP 2.0 and later
  kCola,      ///< SICK TiM3xx, TiM5xx, TiM7xx, LMS1xx, LMS5xx: CoLa-A and CoLa-B
  kVelodyne,  ///< VLP-16 and Puck LITE: data packets by UDP
};

/// The scanner of orchard-laser-driver. Section `drivers.laser`.
struct LaserDriverConfig {
  std::string device;
  LaserProtocol protocol = LaserProtocol::kScip;
  double delay_s = 0.0;
  double scanner_height_m = 0.0;
};

template <class Visitor>
void describe(Visitor& v, LaserDriverConfig& c) {
  v.text(
      "device", c.device,
      "address of the scanner: tcp:192.168.0.10:10940, serial:/dev/ttyACM0:115200, or the port "
      "that a Velodyne sends to: udp:2368, udp:192.168.1.201:2368 for that scanner only; empty = "
      "no scanner");
  v.choice("protocol", c.protocol, {"scip", "cola", "velodyne"},
           "protocol: scip for Hokuyo, cola for SICK, velodyne for VLP-16");
  v.number("scanner_height_m", c.scanner_height_m, 0, 5, "m",
           "velodyne: height of the middle of the scanner above the ground, measured with a ruler; "
           "its layers are joined at laser.height_m, or 0.3 m above the ground where that is 0");
  const bool is_layered = c.protocol == LaserProtocol::kVelodyne;
  v.check(!is_layered || c.scanner_height_m > 0.0, "scanner_height_m",
          "must be above 0 with protocol velodyne: its layers are joined at a height above the "
          "ground");
  v.check(c.device.empty() || (c.device.rfind("udp:", 0) == 0) == is_layered, "device",
          "must begin with udp: for protocol velodyne, with tcp: or serial: for the others");
  v.expert().number("delay_s", c.delay_s, -0.5, 0.5, "s",
                    "by how much the stamps of the scans are late, which are made earlier by it; "
                    "`orchard calibrate delay`");
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
