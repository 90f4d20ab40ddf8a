// SPDX-License-Identifier: BSD-3-Clause
#include "ros/ros_messages.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace orchard::ros {
namespace {

constexpr std::size_t kCdrHeaderBytes = 4;

constexpr std::size_t kMaxFields = 256;
/// derived: empty names, in ROS 1 a header of 16 bytes, a name of 4 and seven numbers.
constexpr std::size_t kTransformBytesMin = 16 + 4 + 7 * sizeof(double);

NotUsed cut_short() { return {"shorter than its type requires"}; }

/// tf of ROS 1 began the names of frames with a slash.
std::string without_slash(const std::string& frame) {
  return frame.substr(frame.rfind('/', 0) == 0 ? 1 : 0);
}

Header read_header(RosReader& reader) {
  if (reader.wire() == Wire::kRos1) reader.number<std::uint32_t>();  // seq
  Header header;
  // ROS 1 has unsigned seconds, ROS 2 signed ones: equal until 2038.
  const std::int64_t seconds = reader.number<std::uint32_t>();
  const std::int64_t nanoseconds = reader.number<std::uint32_t>();
  header.utime = seconds * 1'000'000 + nanoseconds / 1000;
  header.frame = without_slash(reader.text());
  return header;
}

template <std::size_t N>
std::array<double, N> read_doubles(RosReader& reader) {
  std::array<double, N> values{};
  for (double& value : values) value = reader.number<double>();
  return values;
}

/// x, y, z, w.
using Quaternion = std::array<double, 4>;

bool is_unit(const Quaternion& q) {
  const double norm = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  return std::abs(norm - 1.0) < 0.02;
}

double yaw_rad(const Quaternion& q) {
  return std::atan2(2 * (q[3] * q[2] + q[0] * q[1]), 1 - 2 * (q[1] * q[1] + q[2] * q[2]));
}

bool is_finite(std::initializer_list<double> values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

/// Mean of the diagonal of a 3 x 3 covariance; 0 (unknown) when invalid.
double mean_variance(const std::array<double, 9>& covariance) {
  const double a = covariance[0], b = covariance[4], c = covariance[8];
  return is_finite({a, b, c}) && a >= 0 && b >= 0 && c >= 0 ? (a + b + c) / 3 : 0.0;
}

/// Elements of a pose's 6 x 6 covariance for (x, y, yaw): xx xy xyaw yy yyaw yawyaw.
std::array<double, 6> plane_covariance(const std::array<double, 36>& c) {
  const std::array<double, 6> plane{c[0], c[1], c[5], c[7], c[11], c[35]};
  const bool is_usable =
      std::all_of(plane.begin(), plane.end(), [](double v) { return std::isfinite(v); }) &&
      plane[0] >= 0 && plane[3] >= 0 && plane[5] >= 0;
  return is_usable ? plane : std::array<double, 6>{};
}

struct Pose {
  std::array<double, 3> position;
  Quaternion orientation;
};

Pose read_pose(RosReader& reader) {
  Pose pose{};
  pose.position = read_doubles<3>(reader);
  pose.orientation = read_doubles<4>(reader);
  return pose;
}

/// Converts a pose to a fix; an orientation that was never set (all zero) gives no yaw.
std::variant<pose::PoseFix, NotUsed> to_fix(const Header& header, const Pose& pose,
                                            const std::array<double, 6>& covariance) {
  pose::PoseFix fix;
  fix.utime = header.utime;
  fix.x_m = pose.position[0];
  fix.y_m = pose.position[1];
  fix.covariance = covariance;
  const Quaternion& q = pose.orientation;
  fix.has_yaw = !(q[0] == 0.0 && q[1] == 0.0 && q[2] == 0.0 && q[3] == 0.0);
  if (!is_finite({fix.x_m, fix.y_m})) return NotUsed{"a position that is not finite"};
  if (fix.has_yaw && !is_unit(q)) return NotUsed{"an orientation that is not a unit quaternion"};
  if (fix.has_yaw) fix.yaw_rad = yaw_rad(q);
  return fix;
}

}  // namespace

RosReader::RosReader(const void* data, std::size_t size, Wire wire)
    : data_(static_cast<const std::uint8_t*>(data)), size_(size), wire_(wire) {
  if (wire_ == Wire::kRos1) return;
  // The second byte is the byte order: 0 big, 1 little endian. Other values mean parameter lists or
  // XCDR version 2, which ROS does not send.
  if (size < kCdrHeaderBytes || data_[0] != 0 || data_[1] > 1) {
    ok_ = false;
    size_ = 0;
    return;
  }
  is_big_endian_ = data_[1] == 0;
  data_ += kCdrHeaderBytes;  // alignment is relative to the end of the header
  size_ -= kCdrHeaderBytes;
}

const std::uint8_t* RosReader::take(std::size_t size, std::size_t alignment) {
  std::size_t begin = position_;
  if (wire_ == Wire::kCdr) begin = (begin + alignment - 1) / alignment * alignment;
  if (!ok_ || begin > size_ || size > size_ - begin) {
    ok_ = false;
    return nullptr;
  }
  position_ = begin + size;
  return data_ + begin;
}

const std::uint8_t* RosReader::ordered(const std::uint8_t* bytes, std::size_t size) {
  if (!is_big_endian_) return bytes;
  std::reverse_copy(bytes, bytes + size, swapped_);
  return swapped_;
}

std::string RosReader::text() {
  std::size_t size = number<std::uint32_t>();
  const std::uint8_t* begin = take(size, 1);
  if (begin == nullptr) return {};
  // The length of a CDR string includes its terminating zero; ROS 1 strings have none.
  if (wire_ == Wire::kCdr && size > 0 && begin[size - 1] == 0) --size;
  return std::string(reinterpret_cast<const char*>(begin), size);
}

const std::uint8_t* RosReader::bytes(std::size_t& size) {
  size = number<std::uint32_t>();
  const std::uint8_t* begin = take(size, 1);
  if (begin == nullptr) size = 0;
  return begin;
}

std::size_t RosReader::count(std::size_t least_element_bytes) {
  const std::size_t count = number<std::uint32_t>();
  if (count * least_element_bytes > size_ - std::min(position_, size_)) {
    ok_ = false;
    return 0;
  }
  return ok_ ? count : 0;
}

std::vector<float> RosReader::floats() {
  std::vector<float> values(count(sizeof(float)));
  for (float& value : values) value = number<float>();
  if (!ok_) values.clear();
  return values;
}

MessageType message_type(std::string_view name) {
  static const std::map<std::string, MessageType> kTypes{
      {"sensor_msgs/LaserScan", MessageType::kLaserScan},
      {"sensor_msgs/PointCloud2", MessageType::kPointCloud2},
      {"sensor_msgs/Image", MessageType::kImage},
      {"sensor_msgs/CompressedImage", MessageType::kCompressedImage},
      {"sensor_msgs/Imu", MessageType::kImu},
      {"sensor_msgs/NavSatFix", MessageType::kNavSatFix},
      {"nav_msgs/Odometry", MessageType::kOdometry},
      {"geometry_msgs/PoseStamped", MessageType::kPose},
      {"geometry_msgs/PoseWithCovarianceStamped", MessageType::kPoseWithCovariance},
      {"tf2_msgs/TFMessage", MessageType::kTransforms},
      {"tf/tfMessage", MessageType::kTransforms},
      {"sensor_msgs/CameraInfo", MessageType::kCameraInfo}};
  std::string plain(name);
  const std::size_t middle = plain.find("/msg/");
  if (middle != std::string::npos) plain.erase(middle, 4);
  const auto found = kTypes.find(plain);
  return found != kTypes.end() ? found->second : MessageType::kNone;
}

std::variant<Header, NotUsed> decode_header(const void* data, std::size_t size, Wire wire,
                                            MessageType type) {
  RosReader reader(data, size, wire);
  if (type == MessageType::kTransforms && reader.count(kTransformBytesMin) == 0) {
    return NotUsed{"it has no transform"};
  }
  Header header = read_header(reader);
  if (!reader.ok()) return cut_short();
  return header;
}

std::variant<laser::Scan, NotUsed> decode_laser_scan(const void* data, std::size_t size,
                                                     Wire wire) {
  RosReader reader(data, size, wire);
  laser::Scan scan;
  scan.utime = read_header(reader).utime;
  scan.bearing_min_rad = reader.number<float>();
  reader.number<float>();  // angle_max: follows from the others
  scan.bearing_step_rad = reader.number<float>();
  scan.beam_period_us = 1e6 * static_cast<double>(reader.number<float>());
  reader.number<float>();  // scan_time
  scan.range_min_m = reader.number<float>();
  scan.range_max_m = reader.number<float>();
  scan.ranges_m = reader.floats();
  scan.intensities = reader.floats();
  if (!reader.ok()) return cut_short();
  if (!(scan.beam_period_us >= 0.0) || !std::isfinite(scan.beam_period_us)) {
    return NotUsed{"a time_increment that is not a valid duration"};
  }
  for (float& range_m : scan.ranges_m) {
    if (!std::isinf(range_m)) continue;
    range_m = range_m > 0 ? 0.0f : std::numeric_limits<float>::quiet_NaN();
  }
  return scan;
}

std::variant<pose::Imu, NotUsed> decode_imu(const void* data, std::size_t size, Wire wire) {
  RosReader reader(data, size, wire);
  pose::Imu imu;
  imu.utime = read_header(reader).utime;
  const Quaternion q = read_doubles<4>(reader);
  const auto orientation_covariance = read_doubles<9>(reader);
  imu.angular_rate_radps = read_doubles<3>(reader);
  const auto rate_covariance = read_doubles<9>(reader);
  imu.acceleration_mps2 = read_doubles<3>(reader);
  const auto acceleration_covariance = read_doubles<9>(reader);
  if (!reader.ok()) return cut_short();
  // -1 as first element of a covariance: not measured (sensor_msgs/Imu).
  if (rate_covariance[0] == -1.0) return NotUsed{"it has no angular rate"};
  if (acceleration_covariance[0] == -1.0) return NotUsed{"it has no acceleration"};
  imu.angular_rate_variance = mean_variance(rate_covariance);
  imu.acceleration_variance = mean_variance(acceleration_covariance);
  imu.orientation_variance = mean_variance(orientation_covariance);
  // An orientation of exactly zero is the message's initial value: not measured.
  const bool is_initial = q[0] == 0.0 && q[1] == 0.0 && q[2] == 0.0;
  imu.has_orientation = orientation_covariance[0] != -1.0 && is_unit(q) && !is_initial;
  if (imu.has_orientation) {
    const double sine = std::clamp(2 * (q[3] * q[1] - q[2] * q[0]), -1.0, 1.0);
    imu.roll_rad = std::atan2(2 * (q[3] * q[0] + q[1] * q[2]), 1 - 2 * (q[0] * q[0] + q[1] * q[1]));
    imu.pitch_rad = std::asin(sine);
    imu.yaw_rad = yaw_rad(q);
  }
  return imu;
}

std::variant<pose::Gnss, NotUsed> decode_nav_sat_fix(const void* data, std::size_t size,
                                                     Wire wire) {
  constexpr std::int8_t kFix = 0, kSatellites = 1, kGround = 2;
  RosReader reader(data, size, wire);
  pose::Gnss gnss;
  gnss.utime = read_header(reader).utime;
  const auto status = reader.number<std::int8_t>();
  reader.number<std::uint16_t>();  // service
  gnss.latitude_deg = reader.number<double>();
  gnss.longitude_deg = reader.number<double>();
  gnss.altitude_m = reader.number<double>();
  const auto covariance = read_doubles<9>(reader);
  const bool has_covariance = reader.number<std::uint8_t>() != 0;
  if (!reader.ok()) return cut_short();
  if (status < kFix) return NotUsed{"no fix"};
  if (status > kGround) return NotUsed{"an invalid status"};
  if (!is_finite({gnss.latitude_deg, gnss.longitude_deg})) {
    return NotUsed{"a position that is not finite"};
  }
  if (has_covariance) {
    const std::array<double, 6> enu{covariance[0], covariance[1], covariance[2],
                                    covariance[4], covariance[5], covariance[8]};
    const bool is_usable =
        std::all_of(enu.begin(), enu.end(), [](double v) { return std::isfinite(v); }) &&
        enu[0] >= 0.0 && enu[3] >= 0.0 && enu[5] >= 0.0;
    if (is_usable) gnss.covariance = enu;
  }
  if (!std::isfinite(gnss.altitude_m)) {  // NaN marks an unknown altitude
    gnss.altitude_m = 0.0;
    gnss.covariance[2] = gnss.covariance[4] = 0.0;
    gnss.covariance[5] = pose::kUnknownAltitudeVariance_m2;
  }
  gnss.fix_quality = status == kFix ? 1 : status == kSatellites ? 2 : has_covariance ? 4 : 5;
  return gnss;
}

std::variant<Odometry, NotUsed> decode_odometry(const void* data, std::size_t size, Wire wire) {
  RosReader reader(data, size, wire);
  Odometry odometry;
  const Header header = read_header(reader);
  odometry.base_frame = without_slash(reader.text());
  const Pose pose = read_pose(reader);
  const auto pose_covariance = read_doubles<36>(reader);
  const auto twist = read_doubles<6>(reader);
  const auto c = read_doubles<36>(reader);
  if (!reader.ok()) return cut_short();
  odometry.velocity.utime = header.utime;
  odometry.velocity.speed_mps = twist[0];
  odometry.velocity.yaw_rate_radps = twist[5];
  if (!is_finite({twist[0], twist[5]})) return NotUsed{"a velocity that is not finite"};
  if (is_finite({c[0], c[5], c[35]}) && c[0] >= 0 && c[35] >= 0) {
    odometry.velocity.covariance = {c[0], c[5], c[35]};
  }
  auto fix = to_fix(header, pose, plane_covariance(pose_covariance));
  if (auto* none = std::get_if<NotUsed>(&fix)) return std::move(*none);
  odometry.place = std::get<pose::PoseFix>(fix);
  return odometry;
}

std::variant<pose::PoseFix, NotUsed> decode_pose(const void* data, std::size_t size, Wire wire,
                                                 bool with_covariance) {
  RosReader reader(data, size, wire);
  const Header header = read_header(reader);
  const Pose pose = read_pose(reader);
  std::array<double, 6> covariance{};
  if (with_covariance) covariance = plane_covariance(read_doubles<36>(reader));
  if (!reader.ok()) return cut_short();
  return to_fix(header, pose, covariance);
}

std::variant<std::vector<Transform>, NotUsed> decode_transforms(const void* data, std::size_t size,
                                                                Wire wire) {
  RosReader reader(data, size, wire);
  std::vector<Transform> transforms(reader.count(kTransformBytesMin));
  for (Transform& transform : transforms) {
    const Header header = read_header(reader);
    transform.utime = header.utime;
    transform.parent = header.frame;
    transform.child = without_slash(reader.text());
    const Pose pose = read_pose(reader);  // a transform has a pose's layout
    const auto& [x, y, z] = pose.position;
    const Quaternion& q = pose.orientation;
    if (!reader.ok()) return cut_short();
    if (!is_finite({x, y, z}) || !is_unit(q)) return NotUsed{"a transform that is none"};
    transform.T_parent_child =
        Eigen::Translation3d(x, y, z) * Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized();
  }
  return transforms;
}

std::variant<geometry::CameraIntrinsics, NotUsed> decode_camera_info(const void* data,
                                                                     std::size_t size, Wire wire) {
  RosReader reader(data, size, wire);
  geometry::CameraIntrinsics camera;
  read_header(reader);
  camera.height_px = static_cast<int>(reader.number<std::uint32_t>());
  camera.width_px = static_cast<int>(reader.number<std::uint32_t>());
  const std::string model = reader.text();
  std::vector<double> distortion(reader.count(sizeof(double)));
  for (double& value : distortion) value = reader.number<double>();
  const auto k = read_doubles<9>(reader);
  if (!reader.ok()) return cut_short();
  if (!(k[0] > 0.0)) return NotUsed{"a camera without calibration"};
  if (distortion.size() > camera.kc.size() || (!model.empty() && model != "plumb_bob")) {
    return NotUsed{"a lens of model " + model.substr(0, 40) + ", not plumb_bob"};
  }
  camera.fc_px = {k[0], k[4]};
  camera.cc_px = {k[2], k[5]};
  camera.alpha_c = k[1] / k[0];
  std::copy(distortion.begin(), distortion.end(), camera.kc.begin());
  return camera;
}

std::variant<Picture, NotUsed> decode_image(const void* data, std::size_t size, Wire wire) {
  RosReader reader(data, size, wire);
  Picture picture;
  picture.utime = read_header(reader).utime;
  picture.height_px = reader.number<std::uint32_t>();
  picture.width_px = reader.number<std::uint32_t>();
  picture.encoding = reader.text();
  reader.number<std::uint8_t>();  // is_bigendian: irrelevant for one byte per channel
  picture.row_bytes = reader.number<std::uint32_t>();
  picture.data = reader.bytes(picture.num_bytes);
  if (!reader.ok()) return cut_short();
  return picture;
}

std::variant<Picture, NotUsed> decode_compressed_image(const void* data, std::size_t size,
                                                       Wire wire) {
  RosReader reader(data, size, wire);
  Picture picture;
  picture.utime = read_header(reader).utime;
  picture.encoding = reader.text();
  picture.data = reader.bytes(picture.num_bytes);
  if (!reader.ok()) return cut_short();
  return picture;
}

std::variant<PointCloud, NotUsed> decode_point_cloud(const void* data, std::size_t size,
                                                     Wire wire) {
  RosReader reader(data, size, wire);
  PointCloud cloud;
  cloud.utime = read_header(reader).utime;
  cloud.height = reader.number<std::uint32_t>();
  cloud.width = reader.number<std::uint32_t>();
  const std::size_t num_fields = reader.count(13);
  if (num_fields > kMaxFields) return NotUsed{"more than 256 fields per point"};
  for (std::size_t i = 0; i < num_fields && reader.ok(); ++i) {
    PointField field;
    field.name = reader.text();
    field.offset = reader.number<std::uint32_t>();
    field.datatype = reader.number<std::uint8_t>();
    reader.number<std::uint32_t>();  // count
    cloud.fields.push_back(std::move(field));
  }
  cloud.is_big_endian = reader.number<std::uint8_t>() != 0;
  cloud.point_bytes = reader.number<std::uint32_t>();
  cloud.row_bytes = reader.number<std::uint32_t>();
  cloud.data = reader.bytes(cloud.num_bytes);
  reader.number<std::uint8_t>();  // is_dense: each point is checked anyway
  if (!reader.ok()) return cut_short();
  const std::uint64_t row_bytes = std::uint64_t{cloud.width} * cloud.point_bytes;
  const std::uint64_t needed =
      cloud.height == 0 ? 0 : std::uint64_t{cloud.height - 1} * cloud.row_bytes + row_bytes;
  const bool is_whole = cloud.width > 0 && cloud.height > 0 && cloud.point_bytes > 0 &&
                        (cloud.height == 1 || cloud.row_bytes >= row_bytes) &&
                        needed <= cloud.num_bytes;
  if (!is_whole) return NotUsed{"its size does not match its number of points"};
  return cloud;
}

}  // namespace orchard::ros
