// SPDX-License-Identifier: BSD-3-Clause
//
// The truth is geometry: a scanner of 16 lines stands 0.8 m above flat ground among upright round
// posts; each of its rays meets a post, the ground, or nothing.
#include "ros/cloud_slice.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <random>

#include "unit/ros/ros_bytes.hpp"

namespace orchard::ros {
namespace {

using ros_test::Bytes;
using Kind = Bytes::Kind;

constexpr double kPi = 3.14159265358979323846;

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
