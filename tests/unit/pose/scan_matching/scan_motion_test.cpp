// SPDX-License-Identifier: BSD-3-Clause
#include "pose/scan_matching/scan_motion.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "geometry/pose2.hpp"
#include "unit/pose/scan_matching/cast_world.hpp"

namespace orchard::pose {
using geometry::between;
using geometry::compose;

namespace {

constexpr std::int64_t kPeriod_us = 100000;

ScanMotion motion_of(const ScanMotionConfig& config = {}) {
  PoseConfig pose;
  pose.scan_motion = config;
  return ScanMotion(pose, {}, {});
}

void expect_finite(const MeasuredMotion& motion) {
  EXPECT_TRUE(motion.T_from_to.allFinite());
  EXPECT_TRUE(motion.covariance.allFinite());
  EXPECT_TRUE(std::isfinite(motion.matched));
}

/// An S through the orchard: 0.25 m and up to 0.09 rad from scan to scan.
std::vector<Eigen::Vector3d> weaving_path(int num_scans) {
  std::vector<Eigen::Vector3d> path{{2.0, 0.0, 0.0}};
  while (static_cast<int>(path.size()) < num_scans) {
    const double turn_rad = 0.09 * std::cos(0.2 * static_cast<double>(path.size()));
    path.push_back(compose(path.back(), {0.25, 0.0, turn_rad}));
  }
  return path;
}

/// Largest error of the way from the first pose, by adding up the motions.
struct PathError {
  double position_m = 0.0;
  double yaw_rad = 0.0;
  int num_unreliable = 0;
};
PathError drive(const CastWorld& world, const std::vector<Eigen::Vector3d>& path, ScanMotion motion,
                double range_sd_m, int seed) {
  std::mt19937 random(static_cast<unsigned>(seed));
  Eigen::Vector3d T_map_base = path.front();
  PathError worst;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const auto step = motion.add(
        world.scan(static_cast<std::int64_t>(i) * kPeriod_us, path[i], &random, range_sd_m));
    EXPECT_EQ(step.has_value(), i > 0);
    if (!step) continue;
    EXPECT_EQ(step->utime_from, static_cast<std::int64_t>(i - 1) * kPeriod_us);
    EXPECT_EQ(step->utime_to, static_cast<std::int64_t>(i) * kPeriod_us);
    expect_finite(*step);
    T_map_base = compose(T_map_base, step->T_from_to);
    const Eigen::Vector3d error = between(path[i], T_map_base);
    worst.position_m = std::max(worst.position_m, error.head<2>().norm());
    worst.yaw_rad = std::max(worst.yaw_rad, std::abs(error.z()));
    worst.num_unreliable += !step->reliable;
  }
  return worst;
}

TEST(ScanMotion, FollowsAPathAmongTrunksExactly) {
  const PathError worst = drive(orchard_world(), weaving_path(60), motion_of(), 0.0, 1);
  EXPECT_LT(worst.position_m, 0.03);  // of 15 m
  EXPECT_LT(worst.yaw_rad, 0.004);
  EXPECT_EQ(worst.num_unreliable, 0);
}

TEST(ScanMotion, FollowsAPathThroughNoise) {
  const PathError worst = drive(orchard_world(), weaving_path(60), motion_of(), 0.03, 2);
  EXPECT_LT(worst.position_m, 0.10);
  EXPECT_LT(worst.yaw_rad, 0.012);
  EXPECT_EQ(worst.num_unreliable, 0);
}

TEST(ScanMotion, DoesNotCareHowFastTheClockRuns) {
  const CastWorld world = orchard_world();
  const std::vector<Eigen::Vector3d> path = weaving_path(12);
  ScanMotion slow = motion_of(), fast = motion_of();
  for (std::size_t i = 0; i < path.size(); ++i) {
    // stretched a hundredfold, and unevenly
    const auto late = static_cast<std::int64_t>(i * (100 + i)) * kPeriod_us;
    const auto a = slow.add(world.scan(late, path[i], nullptr));
    const auto b =
        fast.add(world.scan(static_cast<std::int64_t>(i) * kPeriod_us, path[i], nullptr));
    if (!a || !b) continue;
    EXPECT_LT((a->T_from_to - b->T_from_to).norm(), 1e-3);
    EXPECT_TRUE(a->reliable && b->reliable);
  }
}

TEST(ScanMotion, FindsATurnOnTheSpotBetweenTwoScans) {
  const CastWorld world = orchard_world();
  for (const double turn_rad : {-1.3, -0.5, 0.4, 1.3}) {
    ScanMotion motion = motion_of();
    std::vector<Eigen::Vector3d> path = weaving_path(12);
    for (std::size_t i = 0; i < path.size(); ++i) {
      motion.add(world.scan(static_cast<std::int64_t>(i) * kPeriod_us, path[i], nullptr));
    }
    const Eigen::Vector3d jump(0.6, 0.2, turn_rad);
    const auto step = motion.add(world.scan(12 * kPeriod_us, compose(path.back(), jump), nullptr));
    ASSERT_TRUE(step);
    EXPECT_TRUE(step->reliable) << turn_rad;
    EXPECT_LT((step->T_from_to - jump).norm(), 0.02) << turn_rad;
  }
}

/// Trunks at random places: nothing repeats.
CastWorld grove() {
  CastWorld world;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-15.0, 15.0);
  while (world.circles.size() < 60) {
    const double x_m = place(random), y_m = place(random);
    if (std::hypot(x_m + 2.0, y_m) > 4.0) world.circles.push_back({{x_m, y_m}, 0.2});
  }
  return world;
}

TEST(ScanMotion, FindsAMotionBeyondTheSearchRangeWhereNothingNearerFits) {
  // Scans were lost: the robot moved farther than search_shift_m and than a fit can be drawn.
  const CastWorld world = grove();
  for (const double turn_rad : {-2.1, -0.5, 0.4, 2.1}) {
    ScanMotion motion = motion_of();
    Eigen::Vector3d T_map_base(-4.0, 1.0, 0.1);
    for (int i = 0; i < 6; ++i) {
      motion.add(world.scan(i * kPeriod_us, T_map_base, nullptr));
      T_map_base = compose(T_map_base, {0.5, 0.0, 0.0});
    }
    const Eigen::Vector3d before = compose(T_map_base, {-0.5, 0.0, 0.0});
    const Eigen::Vector3d jump(1.9, -1.2, turn_rad);
    const auto step = motion.add(world.scan(6 * kPeriod_us, compose(before, jump), nullptr));
    ASSERT_TRUE(step);
    EXPECT_TRUE(step->reliable) << turn_rad;
    EXPECT_LT((step->T_from_to - jump).norm(), 0.02) << turn_rad;
  }
}

/// What a scanner sees that covers the half turn ahead.
laser::Scan ahead(laser::Scan scan) {
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    if (std::abs(scan.bearing_rad(static_cast<int>(i))) > geometry::kPi / 2) scan.ranges_m[i] = 0;
  }
  return scan;
}

TEST(ScanMotion, FindsATurnAmongFarWalls) {
  // At 15 m a turn by 0.05 rad moves a return by 0.75 m, beyond what a fit can draw from.
  CastWorld yard;
  const Eigen::Vector2d corners[] = {{-17.0, -14.0}, {18.0, -15.0}, {17.0, 16.0}, {-18.0, 13.0}};
  for (int i = 0; i < 4; ++i) yard.walls.push_back({corners[i], corners[(i + 1) % 4]});
  for (const Eigen::Vector2d& p : {Eigen::Vector2d(14, 9), {12, -11}, {-9, 10}, {-13, -8}, {3, 12}})
    yard.circles.push_back({p, 0.2});
  for (const double turn_rad : {-0.9, -0.8, -0.7, 0.7, 0.8, 0.9}) {
    ScanMotion motion = motion_of();
    std::mt19937 random(4);
    Eigen::Vector3d T_map_base(-4.0, 1.0, 0.1);
    for (int i = 0; i < 6; ++i) {
      motion.add(ahead(yard.scan(i * kPeriod_us, T_map_base, &random, 0.015)));
      T_map_base = compose(T_map_base, {1.0, 0.0, 0.0});
    }
    const Eigen::Vector3d turn(0.9, 0.4 * turn_rad, turn_rad);
    const Eigen::Vector3d before = compose(T_map_base, {-1.0, 0.0, 0.0});
    const auto step =
        motion.add(ahead(yard.scan(6 * kPeriod_us, compose(before, turn), &random, 0.015)));
    ASSERT_TRUE(step);
    EXPECT_LT((step->T_from_to - turn).norm(), 0.08) << turn_rad;
  }
}

TEST(ScanMotion, SaysThatSmoothWallsTellNothingAlongThem) {
  CastWorld corridor;
  corridor.walls = {{{-100.0, -2.0}, {100.0, -2.0}}, {{-100.0, 2.0}, {100.0, 2.0}}};
  ScanMotion motion = motion_of();
  std::mt19937 random(3);
  for (int i = 0; i < 10; ++i) {
    const auto step =
        motion.add(corridor.scan(i * kPeriod_us, {0.3 * i, 0.02 * i, 0.01 * i}, &random, 0.01));
    if (!step) continue;
    expect_finite(*step);
    EXPECT_FALSE(step->reliable);
    // along: as little as is known without any scan; across and of the turn: well
    EXPECT_GT(std::sqrt(step->covariance(0, 0)), 0.3);
    const Eigen::Vector2d across(std::sin(0.01 * (i - 1)), std::cos(0.01 * (i - 1)));  // in base
    EXPECT_LT(std::sqrt(across.dot(step->covariance.topLeftCorner<2, 2>() * across)), 0.05);
    EXPECT_LT(std::sqrt(step->covariance(2, 2)), 0.01);
    EXPECT_NEAR(step->T_from_to.z(), 0.01, 0.005);
  }
}

/// What wheels measure on a way from one pose to the next within a period, with a lasting error.
Odometry wheels(std::int64_t utime, const Eigen::Vector3d& step, double scale, double turn_scale) {
  Odometry odometry;
  odometry.utime = utime;
  odometry.speed_mps = scale * step.x() / (1e-6 * kPeriod_us);
  odometry.yaw_rate_radps = turn_scale * step.z() / (1e-6 * kPeriod_us);
  return odometry;
}

TEST(ScanMotion, WheelsTellTheWayAlongSmoothWallsAndScansTheTurn) {
  CastWorld corridor;
  corridor.walls = {{{-100.0, -2.0}, {100.0, -2.0}}, {{-100.0, 2.0}, {100.0, 2.0}}};
  ScanMotion motion = motion_of();
  std::mt19937 random(3);
  Eigen::Vector3d T_map_base(0.0, 0.0, 0.0), reached = T_map_base;
  for (int i = 0; i < 40; ++i) {
    const Eigen::Vector3d step(0.3, 0.0, 0.03 * std::cos(0.5 * i));
    motion.add(wheels(i * kPeriod_us, step, 1.02, 1.3));
    if (i > 0) T_map_base = compose(T_map_base, step);
    const auto moved = motion.add(corridor.scan(i * kPeriod_us, T_map_base, &random, 0.01));
    if (moved) reached = compose(reached, moved->T_from_to);
  }
  const Eigen::Vector3d error = between(T_map_base, reached);
  EXPECT_NEAR(error.x() / (39 * 0.3), 0.02, 0.01);  // the wheels' own error
  EXPECT_LT(std::abs(error.y()), 0.1);
  EXPECT_LT(std::abs(error.z()), 0.02);
}

TEST(ScanMotion, WheelsTellWhichOfEqualTrunksIsWhich) {
  // A scan of equal rows fits as well one trunk on. Some scans are lost, and meanwhile the robot
  // drives from one trunk to the next.
  CastWorld rows;
  for (int row = 0; row < 4; ++row) {
    for (int tree = -30; tree < 60; ++tree) {
      rows.circles.push_back({{1.4 * tree, 2.5 * row - 3.75}, 0.05});
    }
  }
  for (const bool has_wheels : {true, false}) {
    ScanMotion motion = motion_of();
    Eigen::Vector3d T_map_base(0.0, 0.0, 0.0), reached = T_map_base;
    for (int i = 0; i < 60; ++i) {
      const Eigen::Vector3d step(0.2, 0.0, 0.0);
      if (i > 0) T_map_base = compose(T_map_base, step);
      if (has_wheels) motion.add(wheels(i * kPeriod_us, step, 1.03, 1.0));
      if (i % 12 > 5) continue;
      const auto moved = motion.add(rows.scan(i * kPeriod_us, T_map_base, nullptr));
      if (moved) reached = compose(reached, moved->T_from_to);
    }
    const double error_m = std::abs(0.2 * 53 - reached.x());
    EXPECT_EQ(error_m < 0.15, has_wheels) << error_m;
  }
}

TEST(ScanMotion, WheelsThatSlipInTurnsAreFoundOut) {
  // Turns are told 40 % too large, far beyond the prior of their scale.
  const CastWorld world = orchard_world();
  const std::vector<Eigen::Vector3d> path = weaving_path(60);
  ScanMotion motion = motion_of();
  for (std::size_t i = 0; i < path.size(); ++i) {
    const auto utime = static_cast<std::int64_t>(i) * kPeriod_us;
    if (i > 0) motion.add(wheels(utime, between(path[i - 1], path[i]), 0.9, 1.4));
    motion.add(world.scan(utime, path[i], nullptr));
  }
  const Eigen::Vector3d reached = compose(path.front(), motion.T_map_base());
  const Eigen::Vector3d error = between(path.back(), reached);
  EXPECT_LT(error.head<2>().norm(), 0.05);
  EXPECT_LT(std::abs(error.z()), 0.005);
}

TEST(ScanMotion, TheNextTrunkOfARowIsNoSlipOfTheWheels) {
  // Trunks every 1.1 m, and crates that are carried on by one of them: there all of the scan fits,
  // though the wheels tell, as surely as they state, that base is not there.
  constexpr double kSpacing_m = 1.1, kSpeedSd_mps = 0.7;
  CastWorld row, carried;
  for (int tree = -30; tree < 40; ++tree) {
    for (CastWorld* world : {&row, &carried}) {
      world->circles.push_back({{kSpacing_m * tree, 2.5}, 0.08});
      world->circles.push_back({{kSpacing_m * tree, -2.5}, 0.08});
    }
  }
  for (int crate = 0; crate < 16; ++crate) {
    const Eigen::Vector2d p(1.6 * crate - 10.0, crate % 2 == 0 ? 1.3 : -1.3);
    row.circles.push_back({p, 0.4});
    carried.circles.push_back({p + Eigen::Vector2d(kSpacing_m, 0.0), 0.4});
  }
  ScanMotion motion = motion_of();
  const Eigen::Vector3d step_m(0.25, 0.0, 0.0);
  for (int i = 0; i < 14; ++i) {
    const std::int64_t utime = i * kPeriod_us;
    if (i > 0) {
      Odometry odometry = wheels(utime, step_m, 1.0, 1.0);
      if (i == 11) odometry.covariance = {kSpeedSd_mps * kSpeedSd_mps, 0.0, 1e-4};
      motion.add(odometry);
    }
    const auto moved =
        motion.add((i == 11 ? carried : row).scan(utime, {0.25 * i, 0.0, 0.0}, nullptr));
    if (i < 2) continue;  // until the map holds more than one view
    ASSERT_TRUE(moved);
    EXPECT_EQ(moved->has_place, i != 11) << i;
    if (i == 11) {
      EXPECT_NEAR(moved->T_from_to.x(), 0.25, 0.01) << "the wheels' meanwhile";
      EXPECT_FALSE(moved->reliable);
      continue;
    }
    // The scan after the carried one tells both steps.
    EXPECT_EQ(moved->utime_from, (i == 12 ? 10 : i - 1) * kPeriod_us);
    EXPECT_NEAR(moved->T_from_to.x(), i == 12 ? 0.5 : 0.25, 0.1) << i;
    EXPECT_TRUE(moved->reliable) << i;
    EXPECT_LT(moved->covariance(0, 0), 0.1 * 0.1) << i;  // the wheels state 0.21
  }
}

TEST(ScanMotion, TheNextGoodScanMendsWhatWasGuessed) {
  // A scan without returns where the wheels slip and say that they may.
  const CastWorld world = orchard_world();
  const std::vector<Eigen::Vector3d> path = weaving_path(40);
  std::mt19937 random(5);
  ScanMotion motion = motion_of();
  for (std::size_t i = 0; i < path.size(); ++i) {
    const auto utime = static_cast<std::int64_t>(i) * kPeriod_us;
    const bool slips = i == 20;
    if (i > 0) {
      Odometry odometry = wheels(utime, between(path[i - 1], path[i]), slips ? 2.2 : 1.0, 1.0);
      if (slips) odometry.covariance = {9.0, 0.0, 0.01};
      motion.add(odometry);
    }
    laser::Scan scan = world.scan(utime, path[i], &random, 0.08);
    if (slips) scan.ranges_m.clear();
    const auto moved = motion.add(scan);
    if (!moved) continue;
    const Eigen::Vector3d wrong_m = between(between(path[i - 1], path[i]), moved->T_from_to);
    EXPECT_FALSE(moved->is_guess) << i << ": the wheels told it";
    if (i == 20) {
      EXPECT_GT(wrong_m.x(), 0.25);
    }
    if (i == 21) {
      EXPECT_NEAR(wrong_m.x(), 0.0, 0.05) << "this step is not what was wrong";
      EXPECT_TRUE(moved->reliable);
    }
  }
  const Eigen::Vector3d reached = compose(path.front(), motion.T_map_base());
  EXPECT_LT(between(path.back(), reached).head<2>().norm(), 0.1);
}

TEST(ScanMotion, TellsWhatTheCalibrationOfTheWheelsWouldChange) {
  // The same drive by wheels that tell a little more; three scans without returns between good
  // ones. There the step is the wheels', and elsewhere hardly.
  const CastWorld world = orchard_world();
  const std::vector<Eigen::Vector3d> path = weaving_path(30);
  const auto driven = [&](double speed, double turn) {
    std::vector<MeasuredMotion> motions;
    ScanMotion motion = motion_of();
    for (std::size_t i = 0; i < path.size(); ++i) {
      const auto utime = static_cast<std::int64_t>(i) * kPeriod_us;
      if (i > 0) motion.add(wheels(utime, between(path[i - 1], path[i]), speed, turn));
      laser::Scan scan = world.scan(utime, path[i], nullptr);
      if (i > 20 && i < 24) scan.ranges_m.clear();
      if (const auto moved = motion.add(scan)) motions.push_back(*moved);
    }
    return motions;
  };
  constexpr double kMore = 0.002;
  const std::vector<MeasuredMotion> plain = driven(1.0, 1.0), faster = driven(1.0 + kMore, 1.0),
                                    rounder = driven(1.0, 1.0 + kMore);
  ASSERT_EQ(plain.size(), path.size() - 1);
  for (std::size_t i = 0; i < plain.size(); ++i) {
    const Eigen::Matrix3d& J = plain[i].calibration_jacobian;
    const bool is_blind = i >= 20 && i < 23;
    if (i > 1) {
      EXPECT_EQ(plain[i].reliable, !is_blind) << i;
    }
    const double step_m = plain[i].T_from_to.head<2>().norm();
    if (is_blind) {
      EXPECT_NEAR(J.col(0).norm(), step_m, 0.01 * step_m);
      EXPECT_LT((faster[i].T_from_to - plain[i].T_from_to - kMore * J.col(0)).norm(), 1e-6) << i;
      EXPECT_LT((rounder[i].T_from_to - plain[i].T_from_to - kMore * J.col(1)).norm(), 1e-6) << i;
    } else if (i >= 12) {  // after the wheels' first scans
      EXPECT_LT(J.col(0).norm(), 0.3 * step_m) << i;
    }
    const Eigen::Matrix3d lasting = plain[i].covariance - plain[i].covariance_calibrated;
    EXPECT_GE(lasting.diagonal().minCoeff(), 0.0) << i << ": known wheels tell no less";
    EXPECT_GT(plain[i].covariance_calibrated.diagonal().minCoeff(), 0.0) << i;
  }
}

TEST(ScanOdometry, AddsUpItsCovarianceFromWhereEachMotionBegan) {
  // Truth: the motions' covariances by numeric derivatives of the composition.
  const CastWorld world = orchard_world();
  const std::vector<Eigen::Vector3d> path{{0.0, 0.0, 0.0}, {0.4, 0.1, 0.5}, {0.7, 0.4, 1.0}};
  constexpr std::int64_t kSecond_us = 1'000'000;
  ScanOdometry odometry(PoseConfig{}, {}, {});
  ScanMotion motion = motion_of();
  Eigen::Vector3d T_map_base = Eigen::Vector3d::Zero();
  Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < path.size(); ++i) {
    const laser::Scan scan =
        world.scan(static_cast<std::int64_t>(i) * kSecond_us, path[i], nullptr);
    odometry.add(scan);
    const std::optional<MeasuredMotion> moved = motion.add(scan);
    if (!moved) continue;
    Eigen::Matrix3d F, G;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d e = 1e-6 * Eigen::Vector3d::Unit(k);
      F.col(k) =
          (compose(T_map_base + e, moved->T_from_to) - compose(T_map_base - e, moved->T_from_to)) /
          2e-6;
      G.col(k) =
          (compose(T_map_base, moved->T_from_to + e) - compose(T_map_base, moved->T_from_to - e)) /
          2e-6;
    }
    P = F * P * F.transpose() + G * moved->covariance * G.transpose();
    T_map_base = motion.T_map_base();
    const std::optional<PoseEstimate> pose = odometry.estimate();
    ASSERT_TRUE(pose);
    Eigen::Matrix3d told;
    const std::array<double, 6>& c = pose->covariance;
    told << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
    EXPECT_TRUE(told.isApprox(P, 1e-5)) << i << "\n" << told << "\n\n" << P;
  }
}

TEST(ScanMotion, SaysThatARoughHedgeTellsLittleAlongIt) {
  // leaves anywhere within a band: another scan sees others
  std::mt19937 random(4);
  std::uniform_real_distribution<double> depth(0.0, 0.25);
  ScanMotion motion = motion_of();
  for (int i = 0; i < 10; ++i) {
    CastWorld hedge;
    for (double x = -25.0; x < 30.0; x += 0.12) {
      hedge.circles.push_back({{x + depth(random), 2.0 + depth(random)}, 0.03});
      hedge.circles.push_back({{x + depth(random), -2.0 - depth(random)}, 0.03});
    }
    const auto step = motion.add(hedge.scan(i * kPeriod_us, {0.3 * i, 0.0, 0.0}, nullptr));
    if (!step) continue;
    EXPECT_FALSE(step->reliable);
    EXPECT_GT(step->covariance(0, 0), 25.0 * step->covariance(1, 1));
  }
}

TEST(ScanMotion, AScanWithoutReturnsGoesOnAsExpectedAndSaysSo) {
  const CastWorld world = orchard_world();
  const std::vector<Eigen::Vector3d> path = weaving_path(20);
  ScanMotion motion = motion_of();
  for (std::size_t i = 0; i < path.size(); ++i) {
    laser::Scan scan = world.scan(static_cast<std::int64_t>(i) * kPeriod_us, path[i], nullptr);
    if (i == 8) scan.ranges_m.clear();
    if (i == 9) scan.ranges_m.assign(897, std::numeric_limits<float>::quiet_NaN());
    if (i == 10) scan.ranges_m.assign(897, std::numeric_limits<float>::infinity());
    if (i == 11) scan.ranges_m.assign(897, 20.0f);
    const bool blind = i >= 8 && i <= 11;
    const auto step = motion.add(scan);
    if (!step) continue;
    expect_finite(*step);
    EXPECT_EQ(step->reliable, !blind) << i;
    EXPECT_EQ(step->is_guess, blind) << i;
    if (blind) {
      EXPECT_GT(step->covariance(0, 0), 0.1);
      EXPECT_EQ(step->matched, 0.0);
    }
  }
}

TEST(ScanMotion, StartsWithoutReturns) {
  ScanMotion motion = motion_of();
  const CastWorld nothing;
  EXPECT_FALSE(motion.add(nothing.scan(0, {0, 0, 0}, nullptr)));
  for (int i = 1; i < 4; ++i) {
    const auto step = motion.add(nothing.scan(i * kPeriod_us, {0.1 * i, 0, 0}, nullptr));
    ASSERT_TRUE(step);
    EXPECT_FALSE(step->reliable);
    EXPECT_EQ(step->T_from_to, Eigen::Vector3d::Zero().eval());
  }
}

TEST(ScanMotion, AHalfTurnWithinATenthOfASecondIsNotBelieved) {
  // As a block of rows seen from its middle fits the other way round, too.
  const CastWorld world = orchard_world();
  ScanMotion motion = motion_of();
  for (int i = 0; i < 12; ++i) {
    const double yaw_rad = i == 11 ? geometry::kPi : 0.0;
    const auto step = motion.add(world.scan(i * kPeriod_us, {0.2 * i, 0.1, yaw_rad}, nullptr));
    if (i < 11) continue;
    ASSERT_TRUE(step);
    EXPECT_FALSE(step->reliable);
    EXPECT_LT((step->T_from_to - Eigen::Vector3d(0.2, 0.0, 0.0)).norm(), 0.05);
    EXPECT_GT(step->covariance(2, 2), 1.0);
  }
}

TEST(ScanMotion, BeingCarriedElsewhereIsNotReliableAndThenItGoesOn) {
  const CastWorld world = orchard_world();
  CastWorld other;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(-12.0, 12.0);
  for (int i = 0; i < 25; ++i) other.circles.push_back({{place(random), place(random)}, 0.1});
  ScanMotion motion = motion_of();
  int first_reliable_again = 0;
  for (int i = 0; i < 24; ++i) {
    const Eigen::Vector3d pose(0.2 * (i % 12), 0.1, 0.0);
    const auto step = motion.add((i < 12 ? world : other).scan(i * kPeriod_us, pose, nullptr));
    if (i == 0) continue;
    ASSERT_TRUE(step);
    expect_finite(*step);
    if (i == 12) {
      EXPECT_FALSE(step->reliable);
    }
    if (i > 12 && step->reliable && first_reliable_again == 0) first_reliable_again = i;
    if (i > 18) {
      EXPECT_TRUE(step->reliable) << i;
      EXPECT_LT((step->T_from_to - Eigen::Vector3d(0.2, 0.0, 0.0)).norm(), 0.03) << i;
    }
  }
  EXPECT_GT(first_reliable_again, 12);
}

TEST(ScanMotion, TheRobotItselfDoesNotHoldItBack) {
  // a mast and a seat that go with the robot fill 60 degrees behind
  const CastWorld world = orchard_world();
  const std::vector<Eigen::Vector3d> path = weaving_path(30);
  const laser::BlindSector blind{geometry::kPi, 0.55};
  ScanMotion motion(PoseConfig(), {}, blind);
  Eigen::Vector3d T_map_base = path.front();
  for (std::size_t i = 0; i < path.size(); ++i) {
    laser::Scan scan = world.scan(static_cast<std::int64_t>(i) * kPeriod_us, path[i], nullptr);
    for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
      if (blind.contains(scan.bearing_rad(static_cast<double>(beam)))) scan.ranges_m[beam] = 0.9f;
    }
    if (const auto step = motion.add(scan)) T_map_base = compose(T_map_base, step->T_from_to);
  }
  EXPECT_LT(between(path.back(), T_map_base).head<2>().norm(), 0.03);
}

TEST(ScanMotion, TheMountIsTakenIntoAccount) {
  // a laser 0.4 m ahead of the turning centre moves sideways where base only turns
  const CastWorld world = orchard_world();
  const Eigen::Vector3d T_base_laser(0.4, -0.1, 0.3);
  laser::LaserConfig mount;
  mount.mount_x_m = T_base_laser.x();
  mount.mount_y_m = T_base_laser.y();
  mount.mount_yaw_rad = T_base_laser.z();
  ScanMotion motion(PoseConfig(), mount, {});
  for (int i = 0; i < 10; ++i) {
    const Eigen::Vector3d T_map_base(8.0, 0.3, 0.05 * i);
    const auto step =
        motion.add(world.scan(i * kPeriod_us, compose(T_map_base, T_base_laser), nullptr));
    if (!step) continue;
    EXPECT_LT((step->T_from_to - Eigen::Vector3d(0, 0, 0.05)).norm(), 0.015);
  }
}

TEST(ScanMotion, UndoesTheMotionWithinAScan) {
  // a weaving robot: up to 0.15 rad while the laser sweeps, which takes as long as the period
  const CastWorld world = orchard_world();
  for (const bool deskew : {true, false}) {
    ScanMotionConfig config;
    config.deskew = deskew;
    ScanMotion motion = motion_of(config);
    Eigen::Vector3d T_map_base(2.0, 0.0, 0.0), reached = T_map_base;
    double worst_m = 0.0;
    for (int i = 0; i < 30; ++i) {
      const Eigen::Vector3d step_of_scan(0.25, 0.0, 0.15 * std::cos(0.5 * i));
      laser::Scan scan = world.scan(i * kPeriod_us, T_map_base, nullptr, 0.0, step_of_scan);
      scan.beam_period_us = kPeriod_us / 897.0;
      if (const auto step = motion.add(scan)) reached = compose(reached, step->T_from_to);
      worst_m = std::max(worst_m, between(T_map_base, reached).head<2>().norm());
      T_map_base = compose(T_map_base, step_of_scan);
    }
    if (deskew) {
      EXPECT_LT(worst_m, 0.10);
    } else {
      EXPECT_GT(worst_m, 0.20) << "the test does not show what deskewing is for";
    }
  }
}

TEST(ScanMotion, AScanThatIsNotLaterIsLeftOut) {
  const CastWorld world = orchard_world();
  ScanMotion motion = motion_of();
  motion.add(world.scan(kPeriod_us, {2, 0, 0}, nullptr));
  EXPECT_FALSE(motion.add(world.scan(kPeriod_us, {3, 0, 0}, nullptr)));
  EXPECT_FALSE(motion.add(world.scan(0, {3, 0, 0}, nullptr)));
  const auto step = motion.add(world.scan(2 * kPeriod_us, {2.2, 0, 0}, nullptr));
  ASSERT_TRUE(step);
  EXPECT_EQ(step->utime_from, kPeriod_us);
  EXPECT_NEAR(step->T_from_to.x(), 0.2, 0.01);
}

}  // namespace
}  // namespace orchard::pose
