// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "geometry/camera_model.hpp"
#include "laser/scan.hpp"
#include "pose/measurements.hpp"

namespace orchard::ros {

/// Serialisation format of a message.
enum class Wire {
  kRos1,  ///< packed, little-endian (ROS wiki, "msg": serialisation)
  kCdr,   ///< four bytes of header, then aligned (OMG DDSI-RTPS 2.3, 10; XCDR version 1)
};

/// Reads the fields of a ROS message in sequence, never beyond its bytes.
///
/// Missing fields read as 0 or empty, and ok() is false from then on: a decoder reads all its
/// fields and checks once.
class RosReader {
 public:
  /// The bytes must outlive the reader.
  RosReader(const void* data, std::size_t size, Wire wire);

  template <class T>
  T number() {
    T value{};
    const std::uint8_t* bytes = take(sizeof(T), sizeof(T));
    if (bytes != nullptr) std::memcpy(&value, ordered(bytes, sizeof(T)), sizeof(T));
    return value;
  }

  /// Reads a string; empty, and not ok, when it does not end within the bytes.
  std::string text();

  /// Reads a sequence of bytes and its size; the result points into the message. Null when none.
  const std::uint8_t* bytes(std::size_t& size);

  /// Reads the number of elements of a sequence, each of at least `least_element_bytes` bytes; not
  /// ok when the remaining bytes are too few.
  std::size_t count(std::size_t least_element_bytes);

  /// Reads a sequence of single-precision numbers.
  std::vector<float> floats();

  Wire wire() const { return wire_; }
  bool ok() const { return ok_; }

 private:
  const std::uint8_t* take(std::size_t size, std::size_t alignment);
  const std::uint8_t* ordered(const std::uint8_t* bytes, std::size_t size);

  const std::uint8_t* data_;
  std::size_t size_;
  std::size_t position_ = 0;
  Wire wire_;
  bool is_big_endian_ = false;
  bool ok_ = true;
  std::uint8_t swapped_[8] = {};
};

/// The supported types of message, for ROS 1 and ROS 2.
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
  kTransforms,
  kCameraInfo,
  kNone,
};

/// Parses the name of a type in the form of ROS 1 ("sensor_msgs/LaserScan") or ROS 2
/// ("sensor_msgs/msg/LaserScan").
MessageType message_type(std::string_view name);

/// The reason why a message is not used, as text for the user.
struct NotUsed {
  std::string why;
};

/// The header of a message: time and frame.
struct Header {
  std::int64_t utime = 0;  ///< 0: not set by the sender
  std::string frame;
};

/// Decodes only the header, which comes first in every type (in transforms: that of the first).
/// NotUsed: message too short, or an invalid time.
std::variant<Header, NotUsed> decode_header(const void* data, std::size_t size, Wire wire,
                                            MessageType type = MessageType::kNone);

/// Decodes sensor_msgs/LaserScan. +inf becomes 0, no return; -inf (too near) and NaN become NaN,
/// not measured (REP 117).
std::variant<laser::Scan, NotUsed> decode_laser_scan(const void* data, std::size_t size, Wire wire);

/// Decodes sensor_msgs/Imu; its frame is assumed to have the axes of base. Variances are the mean
/// of three axes. The orientation is left out where the sender marks it as missing, and where it
/// was never set.
std::variant<pose::Imu, NotUsed> decode_imu(const void* data, std::size_t size, Wire wire);

/// Decodes sensor_msgs/NavSatFix. Fixes with ground-based augmentation count as RTK: fixed when
/// they have a covariance, which then determines their weight, else float. NotUsed without a fix.
std::variant<pose::Gnss, NotUsed> decode_nav_sat_fix(const void* data, std::size_t size, Wire wire);

/// Content of nav_msgs/Odometry: pose and velocity.
struct Odometry {
  pose::Odometry velocity;  ///< from its twist
  pose::PoseFix place;      ///< from its pose
  std::string base_frame;   ///< whose velocity and pose these are
};
std::variant<Odometry, NotUsed> decode_odometry(const void* data, std::size_t size, Wire wire);

/// Decodes geometry_msgs/PoseStamped or PoseWithCovarianceStamped.
std::variant<pose::PoseFix, NotUsed> decode_pose(const void* data, std::size_t size, Wire wire,
                                                 bool with_covariance);

/// The pose of a frame in another, of tf2_msgs/TFMessage; names are without a leading slash.
struct Transform {
  std::int64_t utime = 0;
  std::string parent, child;
  Eigen::Isometry3d T_parent_child = Eigen::Isometry3d::Identity();
};
std::variant<std::vector<Transform>, NotUsed> decode_transforms(const void* data, std::size_t size,
                                                                Wire wire);

/// Decodes sensor_msgs/CameraInfo. NotUsed for a camera without calibration, and for a lens that is
/// not plumb_bob.
std::variant<geometry::CameraIntrinsics, NotUsed> decode_camera_info(const void* data,
                                                                     std::size_t size, Wire wire);

/// Content of sensor_msgs/Image or CompressedImage; `data` points into the message.
struct Picture {
  std::int64_t utime = 0;
  std::uint32_t width_px = 0;  ///< 0 for a compressed image
  std::uint32_t height_px = 0;
  std::uint32_t row_bytes = 0;
  std::string encoding;  ///< "bgr8", ...; for a compressed image its format, "jpeg", ...
  const std::uint8_t* data = nullptr;
  std::size_t num_bytes = 0;
};
std::variant<Picture, NotUsed> decode_image(const void* data, std::size_t size, Wire wire);
std::variant<Picture, NotUsed> decode_compressed_image(const void* data, std::size_t size,
                                                       Wire wire);

/// A field of a point (sensor_msgs/PointField).
struct PointField {
  std::string name;
  std::uint32_t offset = 0;
  std::uint8_t datatype = 0;  ///< 1 int8, 2 uint8, 3 int16, 4 uint16, 5 int32, 6 uint32, 7 and 8
                              ///< floating point of single and double precision
};

/// Content of sensor_msgs/PointCloud2; `data` points into the message and has `height` rows of
/// `width` points.
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
