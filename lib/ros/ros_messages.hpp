// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "laser/scan.hpp"
#include "pose/measurements.hpp"
#include "ros/ros_reader.hpp"

namespace orchard::ros {

/// The kinds of message that are read, of ROS 1 and ROS 2 alike.
enum class MessageType {
  kLaserScan,
  kPointCloud2,
  kImage,
  kCompressedImage,
  kImu,
  kNavSatFix,
  kOdometry,
  kPose,  ///< PoseStamped and PoseWithCovarianceStamped
  kPoseWithCovariance,
  kNone,
};

/// Of a type's name as ROS 1 ("sensor_msgs/LaserScan") or ROS 2 ("sensor_msgs/msg/LaserScan")
/// writes it.
MessageType message_type(std::string_view name);

/// Why a message became nothing, in words for a person.
struct NotUsed {
  std::string why;
};

/// The same in either world: when, and in which frame.
struct Header {
  std::int64_t utime = 0;  ///< 0: the sender did not say
  std::string frame;
};

/// The header alone, which every kind begins with. NotUsed: too short, or a time that is none.
std::variant<Header, NotUsed> decode_header(const void* data, std::size_t size, Wire wire);

/// sensor_msgs/LaserScan. +inf becomes 0, no return; -inf (too near) and NaN become NaN, nothing
/// measured (REP 117).
std::variant<laser::Scan, NotUsed> decode_laser_scan(const void* data, std::size_t size, Wire wire);

/// sensor_msgs/Imu, whose frame is taken for base's axes. Variances are the mean of three axes.
/// The orientation is left out where the sender says so, and where it was never filled in.
std::variant<pose::Imu, NotUsed> decode_imu(const void* data, std::size_t size, Wire wire);

/// sensor_msgs/NavSatFix. Fixes of a ground-based augmentation count as RTK: fixed when they state
/// their covariance, which then decides, else float. NotUsed without a fix.
std::variant<pose::Gnss, NotUsed> decode_nav_sat_fix(const void* data, std::size_t size, Wire wire);

/// What nav_msgs/Odometry says: where and how fast.
struct Odometry {
  pose::Odometry velocity;  ///< of its twist
  pose::PoseFix place;      ///< of its pose
};
std::variant<Odometry, NotUsed> decode_odometry(const void* data, std::size_t size, Wire wire);

/// geometry_msgs/PoseStamped, or PoseWithCovarianceStamped.
std::variant<pose::PoseFix, NotUsed> decode_pose(const void* data, std::size_t size, Wire wire,
                                                 bool with_covariance);

/// sensor_msgs/Image or CompressedImage; `data` lies in the message.
struct Picture {
  std::int64_t utime = 0;
  std::uint32_t width_px = 0;  ///< 0 of a compressed one
  std::uint32_t height_px = 0;
  std::uint32_t row_bytes = 0;
  std::string encoding;  ///< "bgr8", ...; of a compressed one its format, "jpeg", ...
  const std::uint8_t* data = nullptr;
  std::size_t num_bytes = 0;
};
std::variant<Picture, NotUsed> decode_image(const void* data, std::size_t size, Wire wire);
std::variant<Picture, NotUsed> decode_compressed_image(const void* data, std::size_t size,
                                                       Wire wire);

/// A field of a point, as sensor_msgs/PointField describes it.
struct PointField {
  std::string name;
  std::uint32_t offset = 0;
  std::uint8_t datatype = 0;  ///< 1 int8, 2 uint8, 3 int16, 4 uint16, 5 int32, 6 uint32, 7 and 8
                              ///< floating point of single and double precision
};

/// sensor_msgs/PointCloud2; `data` lies in the message and holds height rows of width points.
struct PointCloud {
  std::int64_t utime = 0;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::vector<PointField> fields;
  bool is_big_endian = false;
  std::uint32_t point_bytes = 0;
  std::uint32_t row_bytes = 0;
  const std::uint8_t* data = nullptr;
  std::size_t num_bytes = 0;
};
std::variant<PointCloud, NotUsed> decode_point_cloud(const void* data, std::size_t size, Wire wire);

}  // namespace orchard::ros
