// SPDX-License-Identifier: BSD-3-Clause
#include "ros/ros_messages.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "unit/ros/ros_bytes.hpp"

namespace orchard::ros {
namespace {

using ros_test::Bytes;
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

TEST_P(EveryWire, AnOdometryIsAPlaceAndAVelocity) {
  Bytes bytes(GetParam());
  bytes.header(9, 500'000, "odom").text("base");
  bytes.put(3.0).put(4.0).put(0.0).put(0.0).put(0.0).put(std::sin(kPi / 4)).put(std::cos(kPi / 4));
  for (int i = 0; i < 36; ++i) bytes.put(static_cast<double>(i));
  bytes.put(1.2).put(0.0).put(0.0).put(0.0).put(0.0).put(-0.3);
  for (int i = 0; i < 36; ++i) bytes.put(100.0 + i);
  const auto decoded = decode_odometry(bytes.data(), bytes.size(), wire_of(GetParam()));
  ASSERT_TRUE(std::holds_alternative<Odometry>(decoded));
  const auto& [velocity, place] = std::get<Odometry>(decoded);
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

}  // namespace
}  // namespace orchard::ros
