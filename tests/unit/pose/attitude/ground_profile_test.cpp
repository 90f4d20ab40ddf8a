// SPDX-License-Identifier: BSD-3-Clause
#include "pose/attitude/ground_profile.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <vector>

#include "geometry/angles.hpp"

namespace orchard::pose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// A hillside of 8 % and 6 % with waves of 0.3 m.
double hill_m(double x_m, double y_m) {
  return 0.08 * x_m + 0.06 * y_m + 0.3 * std::sin(x_m / 8.0);
}

/// R_map_base of a robot that stands on the hill, by the normal of the ground.
Matrix3d stand(double x_m, double yaw_rad) {
  const Vector3d normal =
      Vector3d(-0.08 - 0.3 / 8.0 * std::cos(x_m / 8.0), -0.06, 1.0).normalized();
  const Vector3d ahead(std::cos(yaw_rad), std::sin(yaw_rad), 0.0);
  const Vector3d forward =
      Vector3d(ahead.x(), ahead.y(), -(normal.dot(ahead)) / normal.z()).normalized();
  Matrix3d R;
  R << forward, normal.cross(forward), normal;
  return R;
}

struct Drive {
  bool has_tilt = true;
  double pitch_bias_rad = 0.0, tilt_sd_rad = 0.003;
  double height_sd_m = 0.04;
  double shared_fraction = 0.0;                  ///< of the variance: an error that fades in 60 s
  double fixes_from_m = 60.0, fixes_to_m = 0.0;  ///< between them none
  Vector3d antenna_m = Vector3d::Zero();
  bool is_placed_by_antenna = false;  ///< as by fixes of a robot whose tilt nobody knows
  double outlier_fraction = 0.0;
};

/// Up an aisle of 80 m and back down the next one, five readings a metre.
std::vector<GroundReading> readings_of(const Drive& drive, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  const double own = std::sqrt(1.0 - drive.shared_fraction);
  const double all = std::sqrt(drive.shared_fraction);
  std::vector<GroundReading> readings;
  double shared = normal(random);
  for (int i = 0; i <= 800; ++i) {
    shared =
        std::exp(-0.2 / 60.0) * shared + std::sqrt(1.0 - std::exp(-0.4 / 60.0)) * normal(random);
    const bool is_back = i > 400;
    GroundReading r;
    r.utime = 1'000'000 + 200'000 * i;
    r.x_m = 0.2 * (is_back ? 800 - i : i);
    r.y_m = is_back ? 4.0 : 0.0;
    r.yaw_rad = is_back ? geometry::kPi : 0.0;
    const Matrix3d R = stand(r.x_m, r.yaw_rad);
    if (drive.has_tilt) {
      r.tilt = Attitude{std::atan2(R(2, 1), R(2, 2)), -std::asin(R(2, 0)) + drive.pitch_bias_rad,
                        drive.tilt_sd_rad};
    }
    const double height_m = hill_m(r.x_m, r.y_m) + (R * drive.antenna_m).z();
    if (drive.is_placed_by_antenna) {
      r.x_m += (R * drive.antenna_m).x(), r.y_m += (R * drive.antenna_m).y();
    }
    const double way_m = 0.2 * i;
    if (i % 3 == 0 && !(way_m > drive.fixes_to_m && way_m < drive.fixes_from_m)) {
      r.antenna_height_m = height_m + drive.height_sd_m * (own * normal(random) + all * shared) +
                           (uniform(random) < drive.outlier_fraction ? 5.0 : 0.0);
      r.antenna_variance_m2 = drive.height_sd_m * drive.height_sd_m;
    }
    readings.push_back(r);
  }
  return readings;
}

/// Root mean square of the heights' errors and of the errors over their claims.
Vector2d errors(const GroundProfile& profile) {
  double sum2 = 0.0, over2 = 0.0;
  for (const GroundPoint& p : profile) {
    const double error2 = std::pow(p.z_m - hill_m(p.x_m, p.y_m), 2);
    sum2 += error2;
    over2 += error2 / (p.variance_m2 + p.own_variance_m2);
  }
  const auto num = static_cast<double>(profile.size());
  return {std::sqrt(sum2 / num), std::sqrt(over2 / num)};
}

TEST(GroundProfile, HeightsAloneTellTheGround) {
  Drive drive;
  drive.has_tilt = false;
  drive.fixes_from_m = drive.fixes_to_m;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const GroundProfile profile = ground_along(readings_of(drive, seed), Vector3d::Zero());
    ASSERT_GT(profile.size(), 120u);
    EXPECT_FALSE(profile.front().gradient);
    const Vector2d e = errors(profile);
    EXPECT_LT(e.x(), 0.04);
    EXPECT_GT(e.y(), 0.2);
    EXPECT_LT(e.y(), 1.5);
  }
}

TEST(GroundProfile, AnAntennaOfUnknownTiltStandsBesideItsRobot) {
  Drive drive;
  drive.has_tilt = false;
  drive.is_placed_by_antenna = true;
  drive.antenna_m = Vector3d(0.0, 0.0, 3.0);
  drive.height_sd_m = 0.02;
  drive.fixes_from_m = drive.fixes_to_m;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const GroundProfile profile = ground_along(readings_of(drive, seed), drive.antenna_m);
    const Vector2d e = errors(profile);
    EXPECT_GT(e.x(), 0.015);  // 0.5 x 3 m x 0.1^2
    EXPECT_LT(e.y(), 1.3);
  }
}

TEST(GroundProfile, TheTiltBridgesAGapOfFixesAndItsBiasIsLearnt) {
  Drive drive;
  drive.fixes_to_m = 50.0, drive.fixes_from_m = 110.0;  // the turn at the end of the aisle, too
  drive.pitch_bias_rad = 0.006;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const GroundProfile profile = ground_along(readings_of(drive, seed), Vector3d::Zero());
    const Vector2d e = errors(profile);
    EXPECT_LT(e.x(), 0.06);  // taken as true, 0.006 rad are 0.18 m in 30 m
    EXPECT_LT(e.y(), 1.2);
    const GroundPoint& point = profile.at(20);
    ASSERT_TRUE(point.gradient);
    EXPECT_NEAR(point.gradient->x(), 0.08 + 0.3 / 8.0 * std::cos(point.x_m / 8.0), 0.004);
    EXPECT_NEAR(point.gradient->y(), 0.06, 0.002);
  }
}

// Whether each fix errs by itself or neighbours err alike shows in the drive alone.
TEST(GroundProfile, HeightsAreAsCertainAsTheySayWhetherFixesErrAlikeOrNot) {
  for (const double fraction : {0.0, 0.5, 0.95}) {
    Drive drive;
    drive.shared_fraction = fraction;
    drive.pitch_bias_rad = 0.006;
    drive.fixes_from_m = drive.fixes_to_m;
    constexpr int kRuns = 60;
    double over_claim = 0.0, error = 0.0;
    for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
      const Vector2d e = errors(ground_along(readings_of(drive, seed), Vector3d::Zero()));
      over_claim += e.y() * e.y() / kRuns;
      error += e.x() / kRuns;
    }
    // Where all errors are their own the claim is 6 mm, and what one drive tells of them is
    // cautious.
    EXPECT_GT(over_claim, fraction > 0.0 ? 0.7 : 0.5) << fraction;
    EXPECT_LT(over_claim, 1.4) << fraction;
    EXPECT_LT(error, fraction > 0.0 ? 0.04 : 0.012);
  }
}

TEST(GroundProfile, TheAntennaIsAboveTheGroundAndBesideBase) {
  Drive drive;
  drive.height_sd_m = 0.001;
  drive.fixes_from_m = drive.fixes_to_m;
  drive.antenna_m = {-1.0, 0.5, 1.8};
  const auto readings = readings_of(drive, 1);
  EXPECT_LT(errors(ground_along(readings, drive.antenna_m)).x(), 0.004);
  // Untold, it is wrong by its own height and by where it is on the slope.
  EXPECT_GT(errors(ground_along(readings, Vector3d::Zero())).x(), 1.7);
}

TEST(GroundProfile, HeightsFarOffLoseTheirWeight) {
  Drive drive;
  drive.fixes_from_m = drive.fixes_to_m;
  drive.outlier_fraction = 0.05;
  EXPECT_LT(errors(ground_along(readings_of(drive, 2), Vector3d::Zero())).x(), 0.08);
}

TEST(GroundProfile, WithoutAFixThereAreNoHeights) {
  Drive drive;
  drive.fixes_to_m = -1.0, drive.fixes_from_m = 1e9;
  EXPECT_TRUE(ground_along(readings_of(drive, 1), Vector3d::Zero()).empty());
  EXPECT_TRUE(ground_along({}, Vector3d::Zero()).empty());
}

TEST(GroundProfile, AStretchThatNoWayLinksToAFixIsUnknown) {
  Drive drive;
  drive.fixes_to_m = 60.0, drive.fixes_from_m = 1e9;
  auto readings = readings_of(drive, 1);
  for (std::size_t i = 401; i < readings.size(); ++i) readings[i].utime += 60'000'000;  // carried
  const GroundProfile profile = ground_along(readings, Vector3d::Zero());
  EXPECT_LT(profile.at(50).variance_m2, 0.01);
  EXPECT_GT(profile.back().variance_m2, 1e4);
}

}  // namespace
}  // namespace orchard::pose
