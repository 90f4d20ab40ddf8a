// SPDX-License-Identifier: BSD-3-Clause
// The truth is the page of lib/device/lines.
#include "device/lines/sensor_line.hpp"

#include <gtest/gtest.h>

namespace orchard::device {
namespace {

SensorLine good(std::string_view text) {
  const auto parsed = parse_sensor_line(text);
  const auto* line = std::get_if<SensorLine>(&parsed);
  EXPECT_NE(line, nullptr) << text;
  return line == nullptr ? SensorLine{} : *line;
}

std::string why(std::string_view text) {
  const auto parsed = parse_sensor_line(text);
  const auto* bad = std::get_if<BadLine>(&parsed);
  return bad == nullptr ? "" : bad->why;
}

TEST(SensorLine, ReadsVelocities) {
  const SensorLine line = good("V 0.52 -0.013");
  const auto& velocity = std::get<VelocityLine>(line.content);
  EXPECT_DOUBLE_EQ(velocity.speed_mps, 0.52);
  EXPECT_DOUBLE_EQ(velocity.yaw_rate_radps, -0.013);
  EXPECT_EQ(velocity.speed_sd_mps, 0.0);
  EXPECT_FALSE(line.device_time_us);
  const SensorLine with_sds = good("V,+0.5,\t1e-2, 0.01,0.02 ");
  EXPECT_DOUBLE_EQ(std::get<VelocityLine>(with_sds.content).yaw_rate_radps, 0.01);
  EXPECT_DOUBLE_EQ(std::get<VelocityLine>(with_sds.content).yaw_rate_sd_radps, 0.02);
}

TEST(SensorLine, ReadsTicksTimeAndChecksum) {
  const SensorLine line = good("T -81734 4294967295 @1520000");
  EXPECT_EQ(std::get<TickLine>(line.content).left, -81734);
  EXPECT_EQ(std::get<TickLine>(line.content).right, 4294967295);
  EXPECT_EQ(line.device_time_us, 1520000);
  EXPECT_FALSE(line.has_checksum);
  // Exclusive-or of the bytes of "V 0.52 -0.013 @1500000", computed outside this program.
  EXPECT_TRUE(good("V 0.52 -0.013 @1500000*1A").has_checksum);
}

TEST(SensorLine, ReadsAnInertialUnit) {
  const SensorLine short_line = good("I 0.001 -0.002 0.013 0.05 0.02 9.81");
  const auto& inertial = std::get<InertialLine>(short_line.content);
  EXPECT_DOUBLE_EQ(inertial.angular_rate_radps[2], 0.013);
  EXPECT_DOUBLE_EQ(inertial.acceleration_mps2[2], 9.81);
  EXPECT_FALSE(inertial.has_orientation);
  const SensorLine long_line = good("I 0 0 0 0 0 9.8 0.1 0.2 3.0 @7");
  EXPECT_TRUE(std::get<InertialLine>(long_line.content).has_orientation);
  EXPECT_DOUBLE_EQ(std::get<InertialLine>(long_line.content).orientation_rad[2], 3.0);
}

TEST(SensorLine, PassesOverComments) {
  for (const char* text : {"# V 1 2", "#", "  ", ",,", ""}) {
    EXPECT_TRUE(std::holds_alternative<Comment>(parse_sensor_line(text))) << text;
  }
}

TEST(SensorLine, SaysWhatIsWrong) {
  EXPECT_EQ(why("V 0.5"), "V needs speed and yaw rate, optionally with their standard deviations");
  EXPECT_EQ(why("V 0.5 0.x"), "not a number: 0.x");
  EXPECT_EQ(why("V nan 0"), "not a number: nan");
  EXPECT_EQ(why("V 0 inf"), "not a number: inf");
  EXPECT_EQ(why("V 50.1 0"), "out of range: 50.1");
  EXPECT_EQ(why("V 1 1 -0.1 0"), "out of range: -0.1");
  EXPECT_EQ(why("V 1e999 1"), "not a number: 1e999");
  EXPECT_EQ(why("T 1.5 2"), "not a whole number: 1.5");
  EXPECT_EQ(why("T 1 9223372036854775808"), "not a whole number: 9223372036854775808");
  EXPECT_EQ(why("X 1 2"), "begins with none of V, T, I and #");
  EXPECT_EQ(why("v 1 2"), "begins with none of V, T, I and #");
  EXPECT_EQ(why("V 1 2 @-5"), "@ needs a time in whole microseconds");
  EXPECT_EQ(why("@5"), "a time without a measurement");
  EXPECT_EQ(why("V 0.52 -0.013 @1500000*1B"), "the checksum is wrong");
  EXPECT_EQ(why("V 0.52 -0.013 @1500000*4"), "the checksum is not two hexadecimal digits");
  EXPECT_EQ(why("V 1 +-2"), "not a number: +-2");
  EXPECT_EQ(why("I 1 2 3 4 5 6 7"),
            "I needs 3 rates and 3 accelerations, optionally with 3 angles");
  EXPECT_EQ(why(std::string(150, 'a') + std::string(40, ' ')), "begins with none of V, T, I and #");
  EXPECT_EQ(why("V 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1"), "too many words");
}

}  // namespace
}  // namespace orchard::device
