// SPDX-License-Identifier: BSD-3-Clause
#include "pose/filter/on_earth.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <optional>
#include <random>

namespace orchard::pose {
namespace {

constexpr int kRtk = 4;
constexpr int kSingle = 1;

struct Drive {
  FixesOfDrive fixes{GnssConfig{}};
  std::map<std::int64_t, PoseEstimate> poses;

  OnEarth read() const {
    return fixes.along([this](std::int64_t utime) { return std::optional(poses.at(utime)); });
  }
};

/// An aisle up and the next one down, a fix a second. In the map the way down is turned by
/// `bend_rad` about its first place. One fix in `every_nth_stray` is 20 m off.
Drive drive(double bend_rad, int quality, double sd_m, int every_nth_stray = 1000) {
  const geometry::Georeference place{52.0, 5.0, 10.0, 0.0, 0.0, 0.0, 0.0};
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal(0.0, sd_m);
  Drive made;
  for (int i = 0; i < 240; ++i) {
    const bool is_up = i < 120;
    const Eigen::Vector2d p_enu =
        is_up ? Eigen::Vector2d(0.6 * i, 0.0) : Eigen::Vector2d(0.6 * (239 - i), 3.0);
    const Eigen::Vector2d turn(72.0, 0.0);
    const Eigen::Vector2d p_map =
        is_up ? p_enu : Eigen::Vector2d(turn + Eigen::Rotation2Dd(bend_rad) * (p_enu - turn));
    PoseEstimate pose;
    pose.utime = 1'000'000 * (i + 1);
    pose.x_m = p_map.x();
    pose.y_m = p_map.y();
    made.poses[pose.utime] = pose;
    Eigen::Vector2d seen = p_enu + Eigen::Vector2d(normal(random), normal(random));
    if (i % every_nth_stray == 0) seen.y() += 20.0;
    const geometry::Geodetic g = geometry::geodetic_of(place, seen);
    Gnss fix;
    fix.utime = pose.utime;
    fix.latitude_deg = g.latitude_deg;
    fix.longitude_deg = g.longitude_deg;
    fix.altitude_m = 10.0;
    fix.fix_quality = static_cast<std::int8_t>(quality);
    made.fixes.add(fix);
  }
  return made;
}

TEST(OnEarth, APathAlongItsFixesIsNotDoubted) {
  const Drive straight = drive(0.0, kRtk, 0.02, 15);
  const OnEarth read = straight.read();
  ASSERT_TRUE(read.place);
  EXPECT_NEAR(read.place->yaw_rad, 0.0, 1e-3);
  EXPECT_FALSE(read.doubt) << "one stray fix in fifteen is reflected";
}

TEST(OnEarth, ABentPathContradictsItsFixes) {
  const Drive bent = drive(0.05, kRtk, 0.02);
  const OnEarth read = bent.read();
  ASSERT_TRUE(read.doubt);
  EXPECT_EQ(read.doubt->name, "path_contradicts_fixes");
  EXPECT_EQ(read.doubt->key, "pose.slam.use_gnss");
}

TEST(OnEarth, FixesThatErrMoreThanThePathBendsContradictNothing) {
  const Drive bent = drive(0.05, kSingle, 1.5);
  const OnEarth read = bent.read();
  EXPECT_TRUE(read.place);
  EXPECT_FALSE(read.doubt);
}

TEST(OnEarth, WithoutFixesThereIsNoPlace) {
  const OnEarth read = Drive{}.read();
  EXPECT_FALSE(read.place);
  EXPECT_FALSE(read.doubt);
}

}  // namespace
}  // namespace orchard::pose
