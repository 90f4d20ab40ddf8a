// SPDX-License-Identifier: BSD-3-Clause

// The truth is geometry: a scanner of 16 lines stands 0.8 m above flat ground among upright round
// posts; each of its rays meets a post, the ground, or nothing.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "ros/cdr_message.hpp"
#include "ros/cloud_slice.hpp"
#include "ros/frame_tree.hpp"
#include "ros/ros_messages.hpp"

namespace orchard::ros {
namespace {

/// Bytes of a message put together by hand: packed as ROS 1 does, or aligned as CDR is.
class Bytes {
 public:
  enum class Kind { kRos1, kCdrLittle, kCdrBig };
  explicit Bytes(Kind kind) : kind_(kind) {
    if (kind != Kind::kRos1) bytes_ = {0, std::uint8_t(kind == Kind::kCdrLittle), 0, 0};
  }
  template <class T>
  Bytes& put(T value) {
    while (kind_ != Kind::kRos1 && (bytes_.size() - 4) % sizeof(T) != 0) bytes_.push_back(0);
    std::uint8_t raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    if (kind_ == Kind::kCdrBig) std::reverse(raw, raw + sizeof(T));
    bytes_.insert(bytes_.end(), raw, raw + sizeof(T));
    return *this;
  }
  Bytes& text(const std::string& value) {
    const bool has_end = kind_ != Kind::kRos1;
    put(static_cast<std::uint32_t>(value.size() + (has_end ? 1 : 0)));
    bytes_.insert(bytes_.end(), value.begin(), value.end());
    if (has_end) bytes_.push_back(0);
    return *this;
  }
  Bytes& header(std::uint32_t seconds, std::uint32_t nanoseconds, const std::string& frame) {
    if (kind_ == Kind::kRos1) put(std::uint32_t{7});  // seq
    return put(seconds).put(nanoseconds).text(frame);
  }
  Bytes& raw(const std::vector<std::uint8_t>& data) {
    put(static_cast<std::uint32_t>(data.size()));
    bytes_.insert(bytes_.end(), data.begin(), data.end());
    return *this;
  }
  const std::uint8_t* data() const { return bytes_.data(); }
  std::size_t size() const { return bytes_.size(); }

 private:
  Kind kind_;
  std::vector<std::uint8_t> bytes_;
};
using Kind = Bytes::Kind;

constexpr double kPi = 3.14159265358979323846;
constexpr float kInf = std::numeric_limits<float>::infinity();

Wire wire_of(Kind kind) { return kind == Kind::kRos1 ? Wire::kRos1 : Wire::kCdr; }

class EveryWire : public ::testing::TestWithParam<Kind> {};

Bytes scan_bytes(Kind kind) {
  Bytes bytes(kind);
  bytes.header(100, 250'000'000, "laser_of_odd_length");
  bytes.put(-1.5f).put(1.5f).put(0.75f).put(2e-5f).put(0.1f).put(0.05f).put(30.0f);
  bytes.put(std::uint32_t{5}).put(1.0f).put(kInf).put(-kInf).put(2.5f).put(std::nanf(""));
  bytes.put(std::uint32_t{0});
  return bytes;
}

/// A message with one transform, turned by a quarter about z.
Bytes transform_bytes(Kind kind, const std::string& parent, const std::string& child, double x_m) {
  Bytes bytes(kind);
  bytes.put(std::uint32_t{1}).header(7, 500'000'000, parent).text(child);
  const double half = std::sqrt(0.5);
  bytes.put(x_m).put(2.0).put(3.0).put(0.0).put(0.0).put(half).put(half);
  return bytes;
}

Transform transform_of(const std::string& parent, const std::string& child, double x_m) {
  const Bytes bytes = transform_bytes(Kind::kCdrLittle, parent, child, x_m);
  return std::get<std::vector<Transform>>(decode_transforms(bytes.data(), bytes.size(), Wire::kCdr))
      .at(0);
}

TEST_P(EveryWire, TransformsHaveTheirFramesWithoutASlash) {
  const Bytes bytes = transform_bytes(GetParam(), "/base_link", "/mast", 1.5);
  const auto decoded = decode_transforms(bytes.data(), bytes.size(), wire_of(GetParam()));
  const auto& transform = std::get<std::vector<Transform>>(decoded).at(0);
  EXPECT_EQ(transform.utime, 7'500'000);
  EXPECT_EQ(transform.parent, "base_link");
  EXPECT_EQ(transform.child, "mast");
  // x of the child points along y of the parent.
  EXPECT_TRUE(
      (transform.T_parent_child * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(1.5, 3, 3)));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto cut = decode_transforms(bytes.data(), size, wire_of(GetParam()));
    EXPECT_FALSE(std::holds_alternative<std::vector<Transform>>(cut) &&
                 !std::get<std::vector<Transform>>(cut).empty())
        << size;
  }
}

TEST(FrameTree, WhatMovesIsNotFixed) {
  FrameTree tree;
  tree.add(transform_of("odom", "base", 0.0));
  tree.add(transform_of("base", "mast", 1.0));
  tree.add(transform_of("mast", "laser", 1.0));
  tree.add(transform_of("base", "arm", 1.0));
  EXPECT_EQ(tree.root_of("laser"), "base");  // though it has not moved in odom yet
  EXPECT_EQ(tree.world_of("base"), "odom");
  // Two quarter turns: half a turn; the second step goes along the turned axes.
  ASSERT_TRUE(tree.between("base", "laser"));
  EXPECT_TRUE((*tree.between("base", "laser") * Eigen::Vector3d(1, 0, 0))
                  .isApprox(Eigen::Vector3d(-2, 3, 6)));
  EXPECT_TRUE(tree.between("arm", "laser"));
  tree.add(transform_of("base", "arm", 1.1));
  EXPECT_FALSE(tree.between("arm", "laser"));
  EXPECT_FALSE(tree.between("base", "camera"));
}

TEST(FrameTree, TransformsInACircleEnd) {
  FrameTree tree;
  tree.add(transform_of("a", "b", 0.0));
  tree.add(transform_of("b", "a", 0.0));
  tree.root_of("a");
}

TEST(CdrMessage, IsReadBackFieldByField) {
  const std::string bytes = cdr_message(
      "sensor_msgs/msg/LaserScan",
      {{"header", {{"stamp", {{"sec", 3}, {"nanosec", 250'000'000}}}, {"frame_id", "odd"}}},
       {"angle_min", -0.5},
       {"angle_increment", 0.25},
       {"range_max", 30.0},
       {"ranges", {1.5, kInf, 2.5}}});
  const auto decoded = decode_laser_scan(bytes.data(), bytes.size(), Wire::kCdr);
  const auto& scan = std::get<laser::Scan>(decoded);
  EXPECT_EQ(scan.utime, 3'250'000);
  EXPECT_EQ(scan.bearing_min_rad, -0.5);
  EXPECT_EQ(scan.range_max_m, 30.0);
  EXPECT_EQ(scan.ranges_m, (std::vector<float>{1.5f, 0.0f, 2.5f}));
  EXPECT_THROW(cdr_message("std_msgs/msg/Header", {{"frame", "odd"}}), std::invalid_argument);
  EXPECT_THROW(cdr_message("sensor_msgs/msg/Sonar", {}), std::out_of_range);
}

TEST_P(EveryWire, AScanWithItsInfinities) {
  const Bytes bytes = scan_bytes(GetParam());
  const auto decoded = decode_laser_scan(bytes.data(), bytes.size(), wire_of(GetParam()));
  const auto* scan = std::get_if<laser::Scan>(&decoded);
  ASSERT_NE(scan, nullptr);
  EXPECT_EQ(scan->utime, 100'250'000);
  EXPECT_DOUBLE_EQ(scan->bearing_min_rad, -1.5);
  EXPECT_DOUBLE_EQ(scan->bearing_step_rad, 0.75);
  EXPECT_NEAR(scan->beam_period_us, 20.0, 1e-5);
  ASSERT_EQ(scan->ranges_m.size(), 5u);
  EXPECT_EQ(scan->ranges_m[0], 1.0f);
  EXPECT_EQ(scan->ranges_m[1], 0.0f);  // no return
  EXPECT_TRUE(std::isnan(scan->ranges_m[2]));
  EXPECT_EQ(scan->ranges_m[3], 2.5f);
  EXPECT_TRUE(std::isnan(scan->ranges_m[4]));
}

TEST_P(EveryWire, EveryCutIsRefused) {
  const Bytes bytes = scan_bytes(GetParam());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto decoded = decode_laser_scan(bytes.data(), size, wire_of(GetParam()));
    EXPECT_TRUE(std::holds_alternative<NotUsed>(decoded)) << size;
  }
}

TEST_P(EveryWire, ALengthThatCannotBeIsRefusedBeforeMemoryIsTaken) {
  Bytes bytes(GetParam());
  bytes.header(1, 0, "l");
  for (int i = 0; i < 7; ++i) bytes.put(1.0f);
  bytes.put(std::uint32_t{0xFFFFFFFF}).put(1.0f);
  EXPECT_TRUE(std::holds_alternative<NotUsed>(
      decode_laser_scan(bytes.data(), bytes.size(), wire_of(GetParam()))));
}

Bytes imu_bytes(Kind kind, double roll, double pitch, double yaw, double first_covariance) {
  // Rz(yaw) Ry(pitch) Rx(roll) as a quaternion.
  const double cr = std::cos(roll / 2), sr = std::sin(roll / 2), cp = std::cos(pitch / 2),
               sp = std::sin(pitch / 2), cy = std::cos(yaw / 2), sy = std::sin(yaw / 2);
  Bytes bytes(kind);
  bytes.header(5, 0, "imu");
  bytes.put(sr * cp * cy - cr * sp * sy).put(cr * sp * cy + sr * cp * sy);
  bytes.put(cr * cp * sy - sr * sp * cy).put(cr * cp * cy + sr * sp * sy);
  bytes.put(first_covariance);
  for (int i = 1; i < 9; ++i) bytes.put(i % 4 == 0 ? 0.04 : 0.0);
  for (int i = 1; i <= 3; ++i) bytes.put(0.1 * i);
  for (int i = 0; i < 9; ++i) bytes.put(i % 4 == 0 ? 0.01 : 0.0);
  bytes.put(0.5).put(-0.5).put(9.81);
  for (int i = 0; i < 9; ++i) bytes.put(0.0);
  return bytes;
}

TEST_P(EveryWire, AnImuWithItsAngles) {
  const Bytes bytes = imu_bytes(GetParam(), 0.1, -0.2, 2.5, 0.04);
  const auto decoded = decode_imu(bytes.data(), bytes.size(), wire_of(GetParam()));
  const auto* imu = std::get_if<pose::Imu>(&decoded);
  ASSERT_NE(imu, nullptr);
  ASSERT_TRUE(imu->has_orientation);
  EXPECT_NEAR(imu->roll_rad, 0.1, 1e-12);
  EXPECT_NEAR(imu->pitch_rad, -0.2, 1e-12);
  EXPECT_NEAR(imu->yaw_rad, 2.5, 1e-12);
  EXPECT_NEAR(imu->orientation_variance, 0.04, 1e-12);
  EXPECT_NEAR(imu->angular_rate_variance, 0.01, 1e-12);
  EXPECT_EQ(imu->acceleration_variance, 0.0);
  EXPECT_DOUBLE_EQ(imu->angular_rate_radps[2], 0.1 * 3);
  EXPECT_DOUBLE_EQ(imu->acceleration_mps2[2], 9.81);
}

TEST_P(EveryWire, AnOrientationThatWasNotMeasuredIsNone) {
  for (const Bytes& bytes :
       {imu_bytes(GetParam(), 0.1, 0, 0, -1.0), imu_bytes(GetParam(), 0, 0, 0, 0.04)}) {
    const auto decoded = decode_imu(bytes.data(), bytes.size(), wire_of(GetParam()));
    ASSERT_TRUE(std::holds_alternative<pose::Imu>(decoded));
    EXPECT_FALSE(std::get<pose::Imu>(decoded).has_orientation);
  }
}

TEST_P(EveryWire, AFixWithItsQuality) {
  struct Case {
    std::int8_t status;
    std::uint8_t covariance_type;
    int quality;  // 0: no message
  };
  for (const Case& c : {Case{-1, 0, 0}, Case{0, 0, 1}, Case{1, 2, 2}, Case{2, 2, 4}, Case{2, 0, 5},
                        Case{3, 0, 0}}) {
    Bytes bytes(GetParam());
    bytes.header(9, 0, "gps").put(c.status).put(std::uint16_t{1});
    bytes.put(-33.86).put(151.2).put(40.0);
    for (const double v : {1.0, 0.1, 0.2, 0.1, 2.0, 0.3, 0.2, 0.3, 9.0}) bytes.put(v);
    bytes.put(c.covariance_type);
    const auto decoded = decode_nav_sat_fix(bytes.data(), bytes.size(), wire_of(GetParam()));
    const auto* gnss = std::get_if<pose::Gnss>(&decoded);
    ASSERT_EQ(gnss != nullptr, c.quality != 0) << int{c.status};
    if (gnss == nullptr) continue;
    EXPECT_EQ(gnss->fix_quality, c.quality);
    EXPECT_DOUBLE_EQ(gnss->latitude_deg, -33.86);
    const std::array<double, 6> stated{1.0, 0.1, 0.2, 2.0, 0.3, 9.0};
    EXPECT_EQ(gnss->covariance, c.covariance_type ? stated : (std::array<double, 6>{}));
  }
}

TEST_P(EveryWire, AFixWithoutAnAltitudeSaysSo) {
  for (const std::uint8_t covariance_type : {0, 2}) {
    Bytes bytes(GetParam());
    bytes.header(9, 0, "gps").put(std::int8_t{2}).put(std::uint16_t{1});
    bytes.put(-33.86).put(151.2).put(std::nan(""));
    for (const double v : {1.0, 0.1, 0.2, 0.1, 2.0, 0.3, 0.2, 0.3, 9.0}) bytes.put(v);
    bytes.put(covariance_type);
    const auto decoded = decode_nav_sat_fix(bytes.data(), bytes.size(), wire_of(GetParam()));
    const auto& gnss = std::get<pose::Gnss>(decoded);
    EXPECT_EQ(gnss.altitude_m, 0.0);
    EXPECT_EQ(gnss.covariance[0], covariance_type ? 1.0 : 0.0);
    EXPECT_EQ(gnss.covariance[4], 0.0);
    EXPECT_EQ(gnss.covariance[5], pose::kUnknownAltitudeVariance_m2);
  }
}

TEST_P(EveryWire, AnOdometryIsAPlaceAndAVelocity) {
  Bytes bytes(GetParam());
  bytes.header(9, 500'000, "odom").text("base");
  bytes.put(3.0).put(4.0).put(0.0).put(0.0).put(0.0).put(std::sin(kPi / 4)).put(std::cos(kPi / 4));
  for (int i = 0; i < 36; ++i) bytes.put(static_cast<double>(i));
  bytes.put(1.2).put(0.0).put(0.0).put(0.0).put(0.0).put(-0.3);
  for (int i = 0; i < 36; ++i) bytes.put(100.0 + i);
  const auto decoded = decode_odometry(bytes.data(), bytes.size(), wire_of(GetParam()));
  ASSERT_TRUE(std::holds_alternative<Odometry>(decoded));
  const auto& [velocity, place, base_frame] = std::get<Odometry>(decoded);
  EXPECT_EQ(base_frame, "base");
  EXPECT_EQ(velocity.utime, 9'000'500);
  EXPECT_DOUBLE_EQ(velocity.speed_mps, 1.2);
  EXPECT_DOUBLE_EQ(velocity.yaw_rate_radps, -0.3);
  EXPECT_EQ(velocity.covariance, (std::array<double, 3>{100, 105, 135}));
  EXPECT_DOUBLE_EQ(place.x_m, 3.0);
  EXPECT_NEAR(place.yaw_rad, kPi / 2, 1e-12);
  EXPECT_EQ(place.covariance, (std::array<double, 6>{0, 1, 5, 7, 11, 35}));
}

INSTANTIATE_TEST_SUITE_P(Wires, EveryWire,
                         ::testing::Values(Kind::kRos1, Kind::kCdrLittle, Kind::kCdrBig));

TEST(RosMessages, TypesByTheirNamesInBothWorlds) {
  EXPECT_EQ(message_type("sensor_msgs/LaserScan"), MessageType::kLaserScan);
  EXPECT_EQ(message_type("sensor_msgs/msg/LaserScan"), MessageType::kLaserScan);
  EXPECT_EQ(message_type("nav_msgs/msg/Odometry"), MessageType::kOdometry);
  EXPECT_EQ(message_type("sensor_msgs/msg/"), MessageType::kNone);
  EXPECT_EQ(message_type(""), MessageType::kNone);
}

TEST(RosMessages, OtherKindsOfCdrAreRefused) {
  Bytes bytes = scan_bytes(Kind::kCdrLittle);
  std::vector<std::uint8_t> raw(bytes.data(), bytes.data() + bytes.size());
  for (const int kind : {2, 3, 6, 7, 255}) {  // lists of parameters, XCDR 2
    raw[1] = static_cast<std::uint8_t>(kind);
    EXPECT_TRUE(
        std::holds_alternative<NotUsed>(decode_laser_scan(raw.data(), raw.size(), Wire::kCdr)));
  }
}

struct Post {
  double x_m, y_m, radius_m;
};
const std::vector<Post> kPosts{{2.0, 0.3, 0.06}, {-1.5, 2.0, 0.1}, {3.0, -3.0, 0.15}, {0, -5, 0.2}};

/// Horizontal distance to the nearest post's bark along a bearing.
std::optional<double> bark_at(double bearing_rad) {
  std::optional<double> nearest;
  for (const Post& post : kPosts) {
    const double along = post.x_m * std::cos(bearing_rad) + post.y_m * std::sin(bearing_rad);
    const double across = -post.x_m * std::sin(bearing_rad) + post.y_m * std::cos(bearing_rad);
    if (along <= 0.0 || std::abs(across) >= post.radius_m) continue;
    const double range_m = along - std::sqrt(post.radius_m * post.radius_m - across * across);
    if (!nearest || range_m < *nearest) nearest = range_m;
  }
  return nearest;
}

struct Scanner {
  double step_rad = 0.2 * kPi / 180;  // Velodyne's at 600 turns a minute: 0.2 degrees
  double first_rad = 0.7;
  bool clockwise = true;
  bool has_time = true;
  bool has_ring = true;
  double jitter_rad = 0.0;
};

/// One turn: columns of 16 elevations from -15 to 15 degrees, as sensor_msgs/PointCloud2.
Bytes turn_of(const Scanner& scanner, Kind kind) {
  constexpr double kHeight_m = 0.8;
  std::mt19937 random(5);
  std::normal_distribution<double> jitter(0.0, 1.0);
  const int num_columns = static_cast<int>(2 * kPi / scanner.step_rad);
  Bytes points(Kind::kRos1);
  std::uint32_t num_points = 0;
  for (int column = 0; column < num_columns; ++column) {
    const double bearing_rad = scanner.first_rad +
                               (scanner.clockwise ? -1 : 1) * scanner.step_rad * column +
                               scanner.jitter_rad * jitter(random);
    for (int ring = 0; ring < 16; ++ring) {
      const double slope = std::tan((2.0 * ring - 15.0) * kPi / 180);
      double range_m = std::numeric_limits<double>::infinity();
      if (const auto bark_m = bark_at(bearing_rad)) range_m = *bark_m;
      if (slope < 0.0) range_m = std::min(range_m, -kHeight_m / slope);
      const bool is_there = range_m < 50.0;
      const double nan = std::nan("");
      points.put(static_cast<float>(is_there ? range_m * std::cos(bearing_rad) : nan));
      points.put(static_cast<float>(is_there ? range_m * std::sin(bearing_rad) : nan));
      points.put(static_cast<float>(is_there ? range_m * slope : nan));
      points.put(static_cast<std::uint16_t>(ring)).put(std::uint16_t{0});
      points.put(static_cast<float>(0.1 * column / num_columns));
      ++num_points;
    }
  }
  Bytes bytes(kind);
  bytes.header(50, 0, "velodyne").put(std::uint32_t{1}).put(num_points);
  struct Field {
    const char* name;
    std::uint32_t offset;
    std::uint8_t type;
  };
  const std::vector<Field> fields{{"x", 0, 7},
                                  {"y", 4, 7},
                                  {"z", 8, 7},
                                  {scanner.has_ring ? "ring" : "other", 12, 4},
                                  {scanner.has_time ? "time" : "none", 16, 7}};
  bytes.put(static_cast<std::uint32_t>(fields.size()));
  for (const Field& field : fields) {
    bytes.text(field.name).put(field.offset).put(field.type).put(std::uint32_t{1});
  }
  bytes.put(std::uint8_t{0}).put(std::uint32_t{20}).put(20 * num_points);
  bytes.raw({points.data(), points.data() + points.size()});
  bytes.put(std::uint8_t{0});
  return bytes;
}

std::variant<laser::Scan, NotUsed> sliced(const Bytes& bytes, Kind kind, const CloudSlice& slice) {
  const auto cloud = decode_point_cloud(bytes.data(), bytes.size(),
                                        kind == Kind::kRos1 ? Wire::kRos1 : Wire::kCdr);
  EXPECT_TRUE(std::holds_alternative<PointCloud>(cloud));
  return slice_cloud(std::get<PointCloud>(cloud), slice);
}

/// Every beam that looks well onto a post has its bark's distance, but for so many that are empty.
void expect_posts(const laser::Scan& scan, double slack_rad, int most_empty = 0) {
  int num_on_posts = 0, num_empty = 0;
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double bearing_rad = scan.bearing_rad(static_cast<double>(i));
    const auto before = bark_at(bearing_rad - slack_rad), after = bark_at(bearing_rad + slack_rad);
    if (!before || !after) continue;
    ++num_on_posts;
    const auto here = bark_at(bearing_rad);
    ASSERT_TRUE(here.has_value());
    if (scan.ranges_m[i] == 0.0f && ++num_empty <= most_empty) continue;
    EXPECT_NEAR(scan.ranges_m[i], *here, 0.02) << bearing_rad;
  }
  EXPECT_GT(num_on_posts, 50);
}

TEST(CloudSlice, TurnsOfAScannerAreScansOfItsPosts) {
  for (const Kind kind : {Kind::kRos1, Kind::kCdrLittle}) {
    for (const bool clockwise : {true, false}) {
      Scanner scanner;
      scanner.clockwise = clockwise;
      const auto result = sliced(turn_of(scanner, kind), kind, {0.0, 0.6});
      const auto* scan = std::get_if<laser::Scan>(&result);
      ASSERT_NE(scan, nullptr);
      EXPECT_NEAR(std::abs(scan->bearing_step_rad), scanner.step_rad, 1e-6);
      EXPECT_EQ(scan->bearing_step_rad < 0, clockwise);
      EXPECT_NEAR(scan->bearing_min_rad, scanner.first_rad, 1e-3);
      EXPECT_NEAR(scan->beam_period_us, 1e5 / 1800, 0.5);  // a tenth of a second, 1800 columns
      EXPECT_EQ(scan->ranges_m.size(), 1800u);
      expect_posts(*scan, 1.5 * scanner.step_rad);
    }
  }
}

TEST(CloudSlice, WithoutTimesAndLinesToo) {
  Scanner scanner;
  scanner.has_time = scanner.has_ring = false;
  const auto result = sliced(turn_of(scanner, Kind::kRos1), Kind::kRos1, {0.0, 0.6});
  const auto* scan = std::get_if<laser::Scan>(&result);
  ASSERT_NE(scan, nullptr);
  EXPECT_EQ(scan->beam_period_us, 0.0);
  expect_posts(*scan, 1.5 * scanner.step_rad);
}

TEST(CloudSlice, BearingsThatTrembleLeaveFewBeamsEmpty) {
  Scanner scanner;
  scanner.jitter_rad = 0.1 * scanner.step_rad;
  const auto result = sliced(turn_of(scanner, Kind::kRos1), Kind::kRos1, {0.0, 0.6});
  const auto* scan = std::get_if<laser::Scan>(&result);
  ASSERT_NE(scan, nullptr);
  expect_posts(*scan, 2.5 * scanner.step_rad, 2);
}

TEST(CloudSlice, GroundOutsideOfTheSliceIsNoReturn) {
  const Scanner scanner;
  const auto result = sliced(turn_of(scanner, Kind::kRos1), Kind::kRos1, {0.0, 0.6});
  const auto& scan = std::get<laser::Scan>(result);
  int num_empty = 0;
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    if (bark_at(scan.bearing_rad(static_cast<double>(i)) - scanner.step_rad) ||
        bark_at(scan.bearing_rad(static_cast<double>(i)) + scanner.step_rad)) {
      continue;
    }
    EXPECT_EQ(scan.ranges_m[i], 0.0f);
    ++num_empty;
  }
  EXPECT_GT(num_empty, 1500);
}

TEST(CloudSlice, ASliceWithoutPointsAndACloudWithoutPlacesAreNotUsed) {
  const Bytes bytes = turn_of(Scanner(), Kind::kRos1);
  EXPECT_TRUE(std::holds_alternative<NotUsed>(sliced(bytes, Kind::kRos1, {30.0, 0.5})));
  auto cloud = decode_point_cloud(bytes.data(), bytes.size(), Wire::kRos1);
  auto& points = std::get<PointCloud>(cloud);
  points.fields.erase(points.fields.begin());
  EXPECT_TRUE(std::holds_alternative<NotUsed>(slice_cloud(points, {})));
}

}  // namespace
}  // namespace orchard::ros
