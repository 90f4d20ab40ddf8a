// SPDX-License-Identifier: BSD-3-Clause
// The truth is the page of lib/device/lines.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "device/lines/controller_protocol.hpp"
#include "device/lines/line_splitter.hpp"

namespace orchard::device {
namespace {

constexpr std::int64_t kStart_us = 1'700'000'000'000'000;

template <class M>
std::vector<M> taken(Protocol& protocol) {
  std::vector<M> found;
  for (const Measurement& measurement : protocol.take_measurements()) {
    if (const auto* m = std::get_if<M>(&measurement)) found.push_back(*m);
  }
  return found;
}

struct Rig {
  OdometryDriverConfig odometry;
  ImuDriverConfig imu;
};

ControllerProtocol connected(const Rig& rig = {}) {
  ControllerProtocol protocol(rig.odometry, rig.imu);
  protocol.connected(kStart_us);
  protocol.receive("f a line\n", kStart_us);
  return protocol;
}

std::string with_checksum(const std::string& line) {
  char sum[8];
  std::snprintf(sum, sizeof sum, "*%02x\n", line_checksum(line));
  return line + sum;
}

TEST(ControllerProtocol, VelocitiesAreStampedWhenTheyCome) {
  ControllerProtocol protocol = connected();
  EXPECT_EQ(protocol.condition().text,
            "waits for lines; check that the controller is running and the baud rate is right");
  protocol.receive("V 0.5 0.1 0.02", kStart_us + 10);
  protocol.receive(" 0.03\r\n", kStart_us + 20);
  const auto odometry = taken<pose::Odometry>(protocol);
  ASSERT_EQ(odometry.size(), 1u);
  EXPECT_EQ(odometry[0].utime, kStart_us + 20);
  EXPECT_DOUBLE_EQ(odometry[0].speed_mps, 0.5);
  EXPECT_DOUBLE_EQ(odometry[0].covariance[0], 0.0004);
  EXPECT_DOUBLE_EQ(odometry[0].covariance[2], 0.0009);
  EXPECT_EQ(protocol.condition().text, "");
  EXPECT_EQ(protocol.counts().num_good, 1);
  EXPECT_EQ(protocol.counts().num_bad, 0);
}

// A circle of 2 m radius at 0.8 m/s: each wheel's way is known, and so are speed and turn.
TEST(ControllerProtocol, TicksOfACircleThroughManyWrapsAndALostLine) {
  Rig rig;
  rig.odometry.metres_per_tick = {0.0001, -0.0001};  // the right one counts backwards
  rig.odometry.wheel_distance_m = 0.6;
  rig.odometry.counter_bits = 16;  // wraps every 6.5 m
  ControllerProtocol protocol = connected(rig);
  const double speed_mps = 0.8, yaw_rate_radps = 0.4;
  std::vector<pose::Odometry> all;
  std::mt19937 random(3);
  for (int i = 0; i <= 2000; ++i) {
    if (i == 700) continue;  // a line that was lost
    const double t_s = 0.02 * i;
    const auto left = std::llround((speed_mps - 0.3 * yaw_rate_radps) * t_s / 0.0001);
    const auto right = std::llround((speed_mps + 0.3 * yaw_rate_radps) * t_s / 0.0001);
    // The left counter is signed and the right one unsigned.
    const auto line = "T " + std::to_string(static_cast<std::int16_t>(left)) + " " +
                      std::to_string(static_cast<std::uint16_t>(-right)) + " @" +
                      std::to_string((4'294'000'000 + 20'000LL * i) % (1LL << 32));
    const auto delay_us = static_cast<std::int64_t>(random() % 8000);
    protocol.receive(with_checksum(line), kStart_us + 20'000LL * i + delay_us);
    for (const auto& odometry : taken<pose::Odometry>(protocol)) all.push_back(odometry);
  }
  ASSERT_EQ(all.size(), 1999u);
  double way_m = 0.0, turn_rad = 0.0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double step_s = i == 699 ? 0.04 : 0.02;
    way_m += all[i].speed_mps * step_s;
    turn_rad += all[i].yaw_rate_radps * step_s;
    // One tick of rounding at each end of the step, in each wheel.
    EXPECT_NEAR(all[i].speed_mps, speed_mps, 0.0001 / 0.02 + 1e-9);
    EXPECT_NEAR(all[i].yaw_rate_radps, yaw_rate_radps, 0.0002 / 0.6 / 0.02 + 1e-9);
    ASSERT_TRUE(i == 0 || all[i].utime > all[i - 1].utime);
  }
  EXPECT_NEAR(way_m, speed_mps * 40.0, 0.0002);
  EXPECT_NEAR(turn_rad, yaw_rate_radps * 40.0, 0.0004);
  // At the end of the step, and not later than the quickest lines say.
  EXPECT_NEAR(static_cast<double>(all.back().utime - kStart_us), 40e6, 2000.0);
  EXPECT_EQ(protocol.counts().num_bad, 0);
}

TEST(ControllerProtocol, ARestartedControllerMakesNoJump) {
  for (const bool has_time : {true, false}) {
    ControllerProtocol protocol = connected();
    const auto line = [&](std::int64_t ticks, std::int64_t time_us) {
      return "T " + std::to_string(ticks) + " " + std::to_string(ticks) +
             (has_time ? " @" + std::to_string(time_us) : "") + "\n";
    };
    protocol.receive(line(900'000, 500'000'000), kStart_us + 100'000);
    protocol.receive(line(900'010, 500'020'000), kStart_us + 120'000);
    protocol.receive(line(0, 1'000'000), kStart_us + 900'000);
    protocol.receive(line(10, 1'020'000), kStart_us + 920'000);
    const auto odometry = taken<pose::Odometry>(protocol);
    ASSERT_EQ(odometry.size(), 2u) << has_time;
    for (const auto& each : odometry) EXPECT_NEAR(each.speed_mps, 0.5, 1e-6);
    EXPECT_EQ(protocol.counts().num_bad, has_time ? 0 : 1);
  }
}

// 0.02 s between lines: 10 m/s2 change a speed by 0.2 m/s.
TEST(ControllerProtocol, ADamagedSpeedIsRefusedOnceAndCounted) {
  ControllerProtocol protocol = connected();
  std::int64_t utime = kStart_us;
  const auto speeds = [&](std::initializer_list<const char*> lines) {
    for (const char* line : lines) {
      protocol.receive(std::string(line) + "\n", utime += 20'000);
    }
    std::vector<double> found;
    for (const auto& odometry : taken<pose::Odometry>(protocol)) {
      found.push_back(odometry.speed_mps);
    }
    return found;
  };
  using Speeds = std::vector<double>;
  EXPECT_EQ(speeds({"V 0.5 0", "V 0.52 0", "V 5.2 0", "V 0.54 0"}), (Speeds{0.5, 0.52, 0.54}));
  EXPECT_EQ(protocol.counts().num_bad, 1);
  // A turn that the outer wheel would need 32 m/s2 for: the wheels are 0.5 m apart.
  EXPECT_EQ(speeds({"V 0.54 0.013", "V 0.54 2.6", "V 0.54 0.026"}), (Speeds{0.54, 0.54}));
  EXPECT_EQ(protocol.counts().num_bad, 2);
  EXPECT_EQ(speeds({"V 0.73 0", "V 0.54 0"}), (Speeds{0.73, 0.54})) << "9.5 m/s2";
  EXPECT_EQ(speeds({"V 3 0", "V 3 0", "V 3 0"}), (Speeds{3, 3})) << "it goes on";
  EXPECT_EQ(protocol.counts().num_bad, 3);
  const std::string with_sum = with_checksum("V 0.1 0");
  protocol.receive(with_sum, utime += 20'000);
  EXPECT_EQ(taken<pose::Odometry>(protocol).size(), 1u) << "its checksum is right";
}

TEST(ControllerProtocol, ADamagedTickLineCostsNoDistance) {
  for (const bool has_time : {true, false}) {
    ControllerProtocol protocol = connected();  // 1 mm per tick
    double way_m = 0.0;
    std::int64_t last_utime = 0;
    for (int i = 0; i <= 100; ++i) {
      const int ticks = 1000 + 10 * i + (i == 50 ? 400 : 0);  // a 1 that became a 5
      std::string line = "T " + std::to_string(ticks) + " " + std::to_string(1000 + 10 * i);
      if (has_time) line += " @" + std::to_string(20'000 * i);
      protocol.receive(line + "\n", kStart_us + 20'000 * i);
      for (const auto& odometry : taken<pose::Odometry>(protocol)) {
        EXPECT_NEAR(odometry.speed_mps, 0.5, 1e-6) << i;
        EXPECT_NEAR(odometry.yaw_rate_radps, 0.0, 1e-6) << i;
        const std::int64_t from = last_utime == 0 ? odometry.utime - 20'000 : last_utime;
        way_m += 1e-6 * static_cast<double>(odometry.utime - from) * odometry.speed_mps;
        last_utime = odometry.utime;
      }
    }
    EXPECT_NEAR(way_m, 1.0, 1e-4) << has_time;
    EXPECT_EQ(protocol.counts().num_bad, 1) << has_time;
  }
}

// Lines that a USB adapter hands over three at a time, of wheels at 1 m/s that begin to slow down.
TEST(ControllerProtocol, LinesThatComeTogetherAreNotRefused) {
  ControllerProtocol protocol = connected();
  std::string waiting;
  for (int i = 0; i < 300; ++i) {
    const double speed_mps = 1.0 - 0.02 * std::max(0, std::min(i - 100, 50));  // 1 m/s2
    waiting += "V " + std::to_string(speed_mps) + " 0\n";
    if (i % 3 != 2) continue;
    protocol.receive(waiting, kStart_us + 20'000 * i);
    waiting.clear();
  }
  EXPECT_EQ(taken<pose::Odometry>(protocol).size(), 300u);
  EXPECT_EQ(protocol.counts().num_bad, 0);
}

// A unit that lies on its back and is turned by a quarter: roll 180 deg, yaw 90 deg.
TEST(ControllerProtocol, TurnsAnInertialUnitIntoBase) {
  Rig rig;
  rig.imu.mount_rad = {M_PI, 0.0, M_PI / 2};
  ControllerProtocol protocol = connected(rig);
  // Base level, yawing left at 0.3 rad/s, accelerating forward at 1: the unit's z points down, its
  // x to base's left, its y to base's front.
  protocol.receive("I 0 0 -0.3 0 1 -9.8\n", kStart_us + 5);
  const auto imu = taken<pose::Imu>(protocol);
  ASSERT_EQ(imu.size(), 1u);
  EXPECT_NEAR(imu[0].angular_rate_radps[2], 0.3, 1e-12);
  EXPECT_NEAR(imu[0].acceleration_mps2[0], 1.0, 1e-12);
  EXPECT_NEAR(imu[0].acceleration_mps2[1], 0.0, 1e-12);
  EXPECT_NEAR(imu[0].acceleration_mps2[2], 9.8, 1e-12);
  EXPECT_FALSE(imu[0].has_orientation);
  // Base level and facing north (yaw 90 deg): the unit's x points west, its y north, its z down:
  // roll 180 deg, pitch 0, yaw 180 deg.
  protocol.receive("I 0 0 0 0 0 -9.8 3.14159265358979 0 3.14159265358979\n", kStart_us + 9);
  const auto turned = taken<pose::Imu>(protocol);
  ASSERT_EQ(turned.size(), 1u);
  EXPECT_NEAR(turned[0].roll_rad, 0.0, 1e-9);
  EXPECT_NEAR(turned[0].pitch_rad, 0.0, 1e-9);
  EXPECT_NEAR(turned[0].yaw_rad, M_PI / 2, 1e-9);
}

TEST(ControllerProtocol, AfterOneChecksumAllMustHaveOne) {
  ControllerProtocol protocol = connected();
  protocol.receive("V 1 0\n" + with_checksum("V 2 0") + "V 3 0\n", kStart_us + 1);
  EXPECT_EQ(taken<pose::Odometry>(protocol).size(), 2u);
  EXPECT_EQ(protocol.counts().num_bad, 1);
  protocol.connected(kStart_us + 100);
  protocol.receive("\nV 3 0\n", kStart_us + 200);
  EXPECT_EQ(taken<pose::Odometry>(protocol).size(), 1u);
}

TEST(ControllerProtocol, SaysWhenItIsSilentAndGivesUp) {
  ControllerProtocol protocol = connected();
  protocol.receive("V 1 0\n", kStart_us + 100);
  ASSERT_EQ(protocol.deadline(), kStart_us + 1'000'100);
  protocol.expire(kStart_us + 1'000'100);
  EXPECT_NE(protocol.condition().text, "");
  EXPECT_EQ(protocol.failure(), "");
  protocol.receive("V 1 \x1b[2J\n", kStart_us + 1'500'000);
  EXPECT_EQ(protocol.condition().text,
            "waits for a valid line; refused \"V 1 ?[2J\" (not a number: ?[2J)");
  while (protocol.failure().empty()) {
    ASSERT_LT(*protocol.deadline(), kStart_us + 12'000'000);
    protocol.expire(*protocol.deadline());
  }
  protocol.connected(kStart_us + 20'000'000);
  EXPECT_EQ(protocol.failure(), "");
  protocol.receive("\nV 1 0\n", kStart_us + 20'100'000);
  EXPECT_EQ(protocol.condition().text, "");
}

TEST(ControllerProtocol, FollowsTheHostsClockWhenItIsSet) {
  ControllerProtocol protocol = connected();
  protocol.receive("T 0 0\n", kStart_us + 10);
  constexpr std::int64_t kStep_us = -3'600'000'000;
  protocol.host_clock_stepped(kStep_us);
  protocol.receive("T 10 10\n", kStart_us + kStep_us + 20'010);
  const auto odometry = taken<pose::Odometry>(protocol);
  ASSERT_EQ(odometry.size(), 1u);
  EXPECT_EQ(odometry[0].utime, kStart_us + kStep_us + 20'010);
  EXPECT_NEAR(odometry[0].speed_mps, 0.5, 1e-9);
}

std::vector<std::string> split(LineSplitter& splitter, const std::vector<std::string>& pieces) {
  std::vector<std::string> lines;
  for (const std::string& piece : pieces) {
    splitter.add(piece, [&lines](std::string_view line) { lines.emplace_back(line); });
  }
  return lines;
}

TEST(LineSplitter, EndsLinesAtAnyEnd) {
  LineSplitter splitter(10);
  EXPECT_EQ(split(splitter, {"one\ntw", "o\r\nthree\r", "\n\nfour"}),
            (std::vector<std::string>{"one", "two", "three"}));
}

TEST(LineSplitter, DropsAndCountsWhatIsTooLong) {
  LineSplitter splitter(5);
  EXPECT_EQ(split(splitter, {"12345\n123", "456", "789\nab\n"}),
            (std::vector<std::string>{"12345", "ab"}));
  EXPECT_EQ(splitter.num_too_long(), 1);
}

TEST(LineSplitter, SkipsTheHalfLineItJoinsIn) {
  LineSplitter splitter(20);
  split(splitter, {"half"});
  splitter.restart(true);
  EXPECT_EQ(split(splitter, {"e\nwhole\n"}), std::vector<std::string>{"whole"});
  splitter.restart(false);
  EXPECT_EQ(split(splitter, {"whole\n"}), std::vector<std::string>{"whole"});
}

TEST(LineSplitter, TheSizeOfPiecesDoesNotMatter) {
  std::mt19937 random(7);
  std::string text;
  for (int i = 0; i < 2000; ++i) text += "a\nbc\r"[random() % 5];
  LineSplitter whole(6);
  const auto expected = split(whole, {text});
  for (int run = 0; run < 20; ++run) {
    std::vector<std::string> pieces;
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t size = 1 + random() % 9;
      pieces.push_back(text.substr(at, size));
      at += size;
    }
    LineSplitter splitter(6);
    EXPECT_EQ(split(splitter, pieces), expected);
    EXPECT_EQ(splitter.num_too_long(), whole.num_too_long());
  }
}

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
