// SPDX-License-Identifier: BSD-3-Clause
#include "system/real_recordings/altered_drive.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace orchard::test {
namespace {

constexpr double kPi = 3.14159265358979;

/// 40 scans while base drives along x at 1 m a step, of one trunk at (20, 5) in map.
std::vector<io::SensorMessage> drive_past_a_trunk() {
  std::vector<io::SensorMessage> recording;
  for (int k = 0; k < 40; ++k) {
    laser::Scan scan;
    scan.utime = 1'000'000 * k;
    scan.bearing_min_rad = -kPi;
    scan.bearing_step_rad = kPi / 180.0;
    scan.ranges_m.assign(360, 0.0f);
    const double bearing_rad = std::atan2(5.0, 20.0 - k);
    scan.ranges_m[static_cast<std::size_t>(std::lround((bearing_rad + kPi) * 180.0 / kPi))] =
        static_cast<float>(std::hypot(5.0, 20.0 - k));
    pose::PoseFix fix;
    fix.utime = scan.utime;
    fix.x_m = k;
    recording.push_back(scan);
    recording.push_back(fix);
  }
  return recording;
}

AlteredDrive altered(const char* name) {
  return alter(drive_past_a_trunk(), *find_alteration(name), 1);
}

/// Largest distance of the trunk, put into map by the track, from where it stands.
double trunk_off_m(const AlteredDrive& drive, double x_m, double y_m) {
  double most_m = 0.0;
  for (const Station& s : drive) {
    for (std::size_t i = 0; i < s.scan.ranges_m.size(); ++i) {
      const double range_m = s.scan.ranges_m[i];
      if (range_m == 0.0) continue;
      const double angle_rad = s.track.yaw_rad + s.scan.bearing_rad(static_cast<double>(i));
      most_m = std::max(most_m, std::hypot(s.track.x_m + range_m * std::cos(angle_rad) - x_m,
                                           s.track.y_m + range_m * std::sin(angle_rad) - y_m));
    }
  }
  return most_m;
}

constexpr double kHalfABeam_m = 0.2;

TEST(AlteredDrive, ScansAndTrackStayOneWorld) {
  EXPECT_LE(trunk_off_m(altered("as_it_is"), 20.0, 5.0), kHalfABeam_m);
  EXPECT_LE(trunk_off_m(altered("mirrored"), 20.0, -5.0), kHalfABeam_m);
  const double c = std::cos(2.0), s = std::sin(2.0);
  EXPECT_LE(
      trunk_off_m(altered("track_moved"), 40.0 + 20.0 * c - 5.0 * s, -25.0 + 20.0 * s + 5.0 * c),
      kHalfABeam_m);
  for (const char* name : {"backwards", "there_and_back", "thinned", "second_half", "true_speed",
                           "headings_off", "track_gaps", "track_drifts", "track_jumps"}) {
    EXPECT_LE(trunk_off_m(altered(name), 20.0, 5.0), kHalfABeam_m) << name;
  }
}

TEST(AlteredDrive, TimeGoesUpAndEveryCopyHasScansAndFixes) {
  for (const Alteration& alteration : alterations()) {
    const auto drive = alter(drive_past_a_trunk(), alteration, 1);
    ASSERT_GE(drive.size(), 15u) << alteration.name;
    std::size_t num_fixes = 0;
    for (std::size_t i = 0; i < drive.size(); ++i) {
      if (i > 0) {
        EXPECT_GT(drive[i].scan.utime, drive[i - 1].scan.utime) << alteration.name;
      }
      EXPECT_EQ(drive[i].scan.utime, drive[i].track.utime);
      if (drive[i].fix) {
        EXPECT_EQ(drive[i].fix->utime, drive[i].scan.utime);
        ++num_fixes;
      }
    }
    EXPECT_GE(num_fixes, drive.size() / 2) << alteration.name;
    EXPECT_EQ(messages_of(drive).size(), drive.size() + num_fixes);
    EXPECT_EQ(tracked_messages_of(drive).size(), 2 * drive.size());
  }
}

TEST(AlteredDrive, BackwardsEndsWhereTheDriveBegan) {
  const auto drive = altered("backwards");
  EXPECT_EQ(drive.front().track.x_m, 39.0);
  EXPECT_EQ(drive.back().track.x_m, 0.0);
  EXPECT_EQ(altered("there_and_back").size(), 79u);
}

TEST(AlteredDrive, NoiseIsOfItsSeed) {
  const auto noisier = find_alteration("noisier");
  const auto range = [&](std::uint64_t seed) {
    const std::vector<Station> drive = alter(drive_past_a_trunk(), *noisier, seed);
    for (const float r : drive[3].scan.ranges_m) {
      if (r > 0.0f) return r;
    }
    return 0.0f;
  };
  EXPECT_EQ(range(1), range(1));
  EXPECT_NE(range(1), range(2));
  EXPECT_EQ(find_alteration("no such thing"), nullptr);
}

}  // namespace
}  // namespace orchard::test
