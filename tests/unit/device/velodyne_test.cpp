// SPDX-License-Identifier: BSD-3-Clause
// The packets of an emulated VLP-16 that stands in an orchard, through the protocol. What the scans
// must say is computed from the orchard's cylinders.
#include <gtest/gtest.h>
#include <mrpt/obs/CObservationVelodyneScan.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "device/velodyne/velodyne_protocol.hpp"
#include "unit/device/emulated_vlp16.hpp"

namespace orchard::device {
namespace {

using test::Cylinder;
using test::EmulatedVlp16;

constexpr double kPi = EmulatedVlp16::kPi;
constexpr std::int64_t kNoon = 1'700'000'000'000'000;

VelodyneMount mount_of(const EmulatedVlp16& scanner) { return {scanner.orchard.scanner_height_m}; }

/// Hands on packets `from` to `to` as they end, and takes the scans.
std::vector<laser::Scan> scans_of(
    VelodyneProtocol& protocol, const EmulatedVlp16& scanner, int from, int to,
    const std::function<bool(int)>& is_lost = [](int) { return false; }) {
  std::vector<laser::Scan> scans;
  for (int i = from; i < to; ++i) {
    if (is_lost(i)) continue;
    const double arrival_us = scanner.packet_us() * (i + 1);
    protocol.receive(scanner.packet(i), kNoon + std::llround(arrival_us));
    for (Measurement& m : protocol.take_measurements()) {
      scans.push_back(std::get<laser::Scan>(std::move(m)));
    }
  }
  return scans;
}

std::vector<laser::Scan> scans_of(const EmulatedVlp16& scanner, int num_packets) {
  VelodyneProtocol protocol(mount_of(scanner));
  protocol.connected(kNoon);
  return scans_of(protocol, scanner, 0, num_packets);
}

EmulatedVlp16 in_orchard() {
  EmulatedVlp16 scanner;
  scanner.orchard.grass_m = 0.15;
  scanner.orchard.cylinders = {
      {3.0, 0.0, 0.05},  {1.2, -0.9, 0.06},  {-4.0, 2.5, 0.10},         {0.5, 7.0, 0.08},
      {6.0, -6.0, 0.09}, {-9.5, -6.5, 0.10}, {0.0, -3.0, 0.05, 0, 0.5}, {2.0, 3.0, 0.8, 0.7, 3.0}};
  return scanner;
}

/// Number of beams on a cylinder, all of whose ranges must be its own.
int num_beams_on(const laser::Scan& scan, const Cylinder& c) {
  int num = 0;
  const double middle_rad = std::atan2(c.y_m, c.x_m);
  const double half_rad = std::asin(c.radius_m / std::hypot(c.x_m, c.y_m));
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double bearing_rad = scan.bearing_rad(static_cast<double>(i));
    const double off_rad = std::abs(std::remainder(bearing_rad - middle_rad, 2 * kPi));
    if (!scan.valid(i) || off_rad > half_rad + 0.6 * std::abs(scan.bearing_step_rad)) continue;
    ++num;
    // A shot lies within half a beam of it; its range is rounded to 2 mm.
    double nearest_m = 1e9, farthest_m = 0.0;
    for (double part = -0.5; part <= 0.5; part += 0.02) {
      const double m = EmulatedVlp16::level_range_m(c, bearing_rad + part * scan.bearing_step_rad);
      nearest_m = std::min(nearest_m, m);
      if (std::isfinite(m)) farthest_m = std::max(farthest_m, m);
    }
    EXPECT_GE(scan.ranges_m[i], nearest_m - 0.003);
    EXPECT_LE(scan.ranges_m[i], farthest_m + 0.008);  // steep near the side
  }
  return num;
}

TEST(Velodyne, ScanHasTheTrunksAndNeitherGrassNorCrowns) {
  const EmulatedVlp16 scanner = in_orchard();
  const auto scans = scans_of(scanner, 400);
  ASSERT_GE(scans.size(), 3u);
  const laser::Scan& scan = scans[1];
  EXPECT_EQ(scan.ranges_m.size(), 1808u);
  EXPECT_NEAR(scan.bearing_step_rad, -6 * 600e-6 * 55.296 * kPi / 180.0, 1e-7);
  int num_all = 0;
  for (std::size_t i = 0; i < 7; ++i) {
    const Cylinder& c = scanner.orchard.cylinders[i];
    const double width_rad = 2.0 * std::asin(c.radius_m / std::hypot(c.x_m, c.y_m));
    const int num = num_beams_on(scan, c);
    EXPECT_NEAR(num, width_rad / std::abs(scan.bearing_step_rad), 1.5) << i;
    num_all += num;
  }
  int num_valid = 0, num_free = 0, num_unknown = 0;
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    num_valid += scan.valid(i) ? 1 : 0;
    num_free += scan.ranges_m[i] == 0.0f ? 1 : 0;
    num_unknown += std::isnan(scan.ranges_m[i]) ? 1 : 0;
  }
  EXPECT_EQ(num_valid, num_all);  // no grass, no crown
  // The crown hides what lies behind it from the flat layers: that is not said to be free.
  const double crown_rad = 2.0 * std::asin(0.8 / std::hypot(2.0, 3.0));
  EXPECT_NEAR(num_unknown, crown_rad / std::abs(scan.bearing_step_rad), 3.0);
  EXPECT_GT(num_free, 1300);
}

TEST(Velodyne, TrunkIsSeenAtEveryDistanceAtItsHeight) {
  for (const double height_m : {0.3, 0.6, 1.0, 1.5}) {
    EmulatedVlp16 scanner;
    scanner.orchard.scanner_height_m = height_m;
    for (double at_m = 0.8; at_m < 15.0; at_m *= 1.07) {
      // What is above twice the spacing of layers, or below 0.17 m, must not be needed to see it.
      const double spacing_m = at_m * std::tan(2.0 * kPi / 180.0);
      const double lowest_m = height_m - (at_m - 0.1) * std::tan(15.0 * kPi / 180.0);
      const double top_m = std::max(0.3 + spacing_m, lowest_m + 0.01);
      scanner.orchard.cylinders = {{at_m, 0.0, 0.1, 0.17, top_m}};
      const auto scans = scans_of(scanner, 240);
      ASSERT_FALSE(scans.empty());
      const double width_rad = 2.0 * std::asin(0.1 / at_m);
      EXPECT_NEAR(num_beams_on(scans.back(), scanner.orchard.cylinders.front()),
                  width_rad / std::abs(scans.back().bearing_step_rad), 1.6)
          << height_m << " m, at " << at_m << " m";
    }
  }
}

TEST(Velodyne, StampIsThatOfTheFirstBeamAlsoPastTheHour) {
  EmulatedVlp16 scanner = in_orchard();
  scanner.start_us = 3'599'700'000;
  const auto scans = scans_of(scanner, 1000);
  ASSERT_GE(scans.size(), 11u);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    // Where the head looked at the time of a beam, but for azimuths rounded to 0.01 degrees twice.
    for (const double beam : {0.0, 1807.0}) {
      const double beam_us =
          static_cast<double>(scans[i].utime - kNoon) + beam * scans[i].beam_period_us;
      const double bearing_rad = -scanner.azimuth_at(beam_us) * kPi / 180.0;
      EXPECT_NEAR(std::remainder(scans[i].bearing_rad(beam) - bearing_rad, 2 * kPi), 0.0, 2e-4);
    }
    EXPECT_NEAR(scans[i].bearing_min_rad, kPi, 0.008);  // straight behind
    const std::int64_t before_utime = i > 0 ? scans[i - 1].utime : scans[i].utime - 100'000;
    EXPECT_NEAR(static_cast<double>(scans[i].utime - before_utime), 1e5, 120.0);
  }
}

TEST(Velodyne, OtherSpeedsHaveOtherSteps) {
  for (const auto& [rate_rpm, num_beams] :
       {std::pair{300.0, 3616u}, {1200.0, 904u}, {595.0, 1823u}, {630.0, 1722u}}) {
    EmulatedVlp16 scanner = in_orchard();
    scanner.rate_rpm = rate_rpm;
    const auto scans = scans_of(scanner, 700);
    ASSERT_GE(scans.size(), 2u);
    const laser::Scan& scan = scans.back();
    EXPECT_NEAR(static_cast<double>(scan.ranges_m.size()), num_beams, 2.0);
    EXPECT_NEAR(std::abs(scan.bearing_step_rad), rate_rpm * 6e-6 * 55.296 * kPi / 180, 1e-7);
    const Cylinder& c = scanner.orchard.cylinders.front();
    EXPECT_NEAR(num_beams_on(scan, c),
                2.0 * std::asin(0.05 / 3.0) / std::abs(scan.bearing_step_rad), 1.5);
  }
}

TEST(Velodyne, LastOfTwoReturnsLooksThroughLeaves) {
  EmulatedVlp16 scanner;
  scanner.orchard.cylinders = {{3.0, 0.0, 0.1}, {2.0, 0.0, 0.3, 0.0, 0.7, true}};
  for (const std::uint8_t returns : {EmulatedVlp16::kDual, EmulatedVlp16::kLast}) {
    scanner.returns = returns;
    const auto scans = scans_of(scanner, returns == EmulatedVlp16::kDual ? 500 : 250);
    ASSERT_FALSE(scans.empty());
    const laser::Scan& scan = scans.back();
    EXPECT_EQ(scan.ranges_m.size(), 1808u);
    EXPECT_NEAR(num_beams_on(scan, scanner.orchard.cylinders.front()), 19.1, 1.5);
    EXPECT_NEAR(scan.ranges_m[904], 2.9, 0.003);
    EXPECT_EQ(scan.intensities[904], 20.0f);
  }
  scanner.returns = EmulatedVlp16::kStrongest;
  EXPECT_NEAR(scans_of(scanner, 250).back().ranges_m[904], 1.7, 0.003);
}

TEST(Velodyne, LostPacketsLeaveTheirBeamsUnmeasured) {
  const EmulatedVlp16 scanner = in_orchard();
  VelodyneProtocol protocol(mount_of(scanner));
  protocol.connected(kNoon);
  const auto whole = scans_of(scanner, 800);
  const auto scans =
      scans_of(protocol, scanner, 0, 800, [](int i) { return i > 300 && i % 10 == 0; });
  ASSERT_EQ(scans.size(), whole.size());
  EXPECT_NE(protocol.condition().text.find("lost on the way"), std::string::npos);
  EXPECT_EQ(protocol.condition().severity, Severity::kWarning);
  EXPECT_EQ(protocol.counts().num_bad, 49);
  int num_lost = 0, num_other = 0;
  for (std::size_t i = 0; i < whole.back().ranges_m.size(); ++i) {
    const float a_m = whole.back().ranges_m[i], b_m = scans.back().ranges_m[i];
    if (std::isnan(b_m) && !std::isnan(a_m)) {
      ++num_lost;
    } else if (!std::isnan(b_m) && a_m != b_m) {
      ++num_other;
    }
  }
  EXPECT_NEAR(num_lost, 170, 60);  // a tenth of the beams, less those behind the crown
  EXPECT_LE(num_other, 4);
}

TEST(Velodyne, HalfATurnIsNoScan) {
  const EmulatedVlp16 scanner = in_orchard();
  VelodyneProtocol protocol(mount_of(scanner));
  protocol.connected(kNoon);
  const auto scans =
      scans_of(protocol, scanner, 0, 800, [](int i) { return i > 300 && i % 4 != 0; });
  EXPECT_LE(scans.size(), 5u);
  EXPECT_NE(protocol.condition().text.find("more than half of a turn is missing"),
            std::string::npos);
}

TEST(Velodyne, OvertakenAndDoubledPacketsChangeNothing) {
  const EmulatedVlp16 scanner = in_orchard();
  const auto whole = scans_of(scanner, 600);
  VelodyneProtocol protocol(mount_of(scanner));
  protocol.connected(kNoon);
  std::vector<laser::Scan> scans;
  for (int i = 0; i < 600; ++i) {
    const int number = i % 12 == 3 ? i + 2 : i % 12 == 5 ? i - 2 : i;
    const auto arrival = kNoon + std::llround(scanner.packet_us() * (std::max(i, number) + 1));
    protocol.receive(scanner.packet(number), arrival);
    if (i % 50 == 0) protocol.receive(scanner.packet(number), arrival);
    for (Measurement& m : protocol.take_measurements()) {
      scans.push_back(std::get<laser::Scan>(std::move(m)));
    }
  }
  ASSERT_EQ(scans.size(), whole.size());
  for (std::size_t i = 0; i < scans.size(); ++i) {
    for (std::size_t beam = 0; beam < scans[i].ranges_m.size(); ++beam) {
      const float a_m = whole[i].ranges_m[beam], b_m = scans[i].ranges_m[beam];
      ASSERT_TRUE(a_m == b_m || (std::isnan(a_m) && std::isnan(b_m))) << i << " " << beam;
    }
    EXPECT_NEAR(static_cast<double>(scans[i].utime - whole[i].utime), 0.0, 3000.0);
  }
  EXPECT_EQ(protocol.counts().num_bad, 12);
}

TEST(EmulatedVlp16, AnotherReaderFindsTheSameOrchard) {
  const EmulatedVlp16 scanner = in_orchard();
  mrpt::obs::CObservationVelodyneScan others;
  others.minRange = 0.1;
  others.calibration = mrpt::obs::VelodyneCalibration::LoadDefaultCalibration("VLP16");
  others.scan_packets.resize(75);
  static_assert(sizeof(others.scan_packets[0]) == VelodynePacket::kNumBytes);
  for (std::size_t i = 0; i < others.scan_packets.size(); ++i) {
    const std::string bytes = scanner.packet(static_cast<int>(i));
    std::memcpy(static_cast<void*>(&others.scan_packets[i]), bytes.data(), bytes.size());
  }
  others.generatePointCloud();
  const auto& points = others.point_cloud;
  ASSERT_GT(points.x.size(), 5'000u);
  std::size_t num_on_trunks = 0;
  for (std::size_t i = 0; i < points.x.size(); ++i) {
    // On the grass, or on a cylinder: where a beam is off in azimuth by 0.01 degrees.
    double off_m = std::abs(points.z[i] + 0.85);
    for (const Cylinder& c : scanner.orchard.cylinders) {
      const double to_axis_m = std::hypot(points.x[i] - c.x_m, points.y[i] - c.y_m);
      const double off_c_m = std::abs(to_axis_m - c.radius_m);
      if (off_c_m < 0.02) ++num_on_trunks;
      off_m = std::min(off_m, off_c_m);
    }
    ASSERT_LT(off_m, 0.02) << points.x[i] << " " << points.y[i] << " " << points.z[i];
  }
  EXPECT_GT(num_on_trunks, 500u);
}

TEST(Velodyne, ScannerThatStartsAgainGoesOn) {
  EmulatedVlp16 scanner = in_orchard();
  scanner.start_us = 500'000'000;
  VelodyneProtocol protocol(mount_of(scanner));
  protocol.connected(kNoon);
  EXPECT_GE(scans_of(protocol, scanner, 0, 400).size(), 3u);
  scanner.start_us = 0;
  const auto scans = scans_of(protocol, scanner, 400, 900);
  EXPECT_GE(scans.size(), 4u);
  EXPECT_EQ(protocol.condition().severity, Severity::kNone);
  EXPECT_EQ(protocol.condition().text, "600 rpm; the strongest return");
}

TEST(Velodyne, SilenceIsAnErrorAndEnds) {
  const EmulatedVlp16 scanner = in_orchard();
  VelodyneProtocol protocol(mount_of(scanner));
  protocol.connected(kNoon);
  EXPECT_EQ(protocol.condition().severity, Severity::kWaiting);
  ASSERT_TRUE(protocol.deadline());
  protocol.expire(*protocol.deadline());
  EXPECT_EQ(protocol.condition().severity, Severity::kError);
  EXPECT_NE(protocol.condition().text.find("no packet arrives"), std::string::npos);
  EXPECT_TRUE(protocol.failure().empty());
  EXPECT_GE(scans_of(protocol, scanner, 2000, 2400).size(), 3u);
  EXPECT_EQ(protocol.condition().severity, Severity::kNone);
}

std::string reason(const std::string& bytes) {
  const auto parsed = VelodynePacket::parse(bytes);
  const auto* why = std::get_if<std::string>(&parsed);
  return why == nullptr ? "" : *why;
}

TEST(VelodynePacket, OthersAreNamed) {
  const std::string good = EmulatedVlp16().packet(7);
  EXPECT_EQ(reason(good), "");
  const auto with = [&good](std::size_t at, int value) {
    std::string bytes = good;
    bytes[at] = static_cast<char>(value);
    return reason(bytes);
  };
  EXPECT_NE(with(1205, 0x28).find("a VLP-32C"), std::string::npos);
  EXPECT_NE(with(1205, 0x77).find("unknown number 119"), std::string::npos);
  EXPECT_NE(with(1204, 0x36).find("return mode, 54"), std::string::npos);
  EXPECT_NE(with(1203, 0xff).find("an hour or more"), std::string::npos);
  EXPECT_NE(with(300, 0).find("flag"), std::string::npos);
  EXPECT_NE(with(303, 0xff).find("360 degrees"), std::string::npos);
  EXPECT_NE(reason(std::string(512, 'x')).find("8308"), std::string::npos);
  for (std::size_t size = 0; size < good.size(); size += 7) {
    EXPECT_NE(reason(good.substr(0, size)), "") << size;
  }
  EXPECT_NE(reason(good + "x"), "");
  EmulatedVlp16 stopped;
  stopped.rate_rpm = 0.0;
  EXPECT_NE(reason(stopped.packet(1)).find("300 to 1200"), std::string::npos);
  EmulatedVlp16 two;
  two.returns = EmulatedVlp16::kDual;
  std::string unlike = two.packet(0);
  unlike[102] = static_cast<char>(unlike[102] + 30);
  EXPECT_NE(reason(unlike).find("unlike azimuths"), std::string::npos);
}

TEST(Velodyne, WrongPacketsAreAnErrorThatSaysWhy) {
  VelodyneProtocol protocol({1.0});
  protocol.connected(kNoon);
  std::string other = EmulatedVlp16().packet(0);
  other[1205] = '\x21';
  for (int i = 0; i < 10; ++i) protocol.receive(other, kNoon + i * 1000);
  EXPECT_EQ(protocol.condition().severity, Severity::kError);
  EXPECT_NE(protocol.condition().text.find("an HDL-32E"), std::string::npos);
  EXPECT_TRUE(protocol.take_measurements().empty());
}

}  // namespace
}  // namespace orchard::device
