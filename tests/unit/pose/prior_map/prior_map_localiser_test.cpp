// SPDX-License-Identifier: BSD-3-Clause
#include "pose/prior_map/prior_map_localiser.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <string>

#include "geometry/angles.hpp"
#include "geometry/pose2.hpp"
#include "pose/filter/fusion.hpp"
#include "pose/localiser.hpp"
#include "unit/pose/prior_map/prior_world.hpp"
#include "unit/pose/scan_matching/cast_world.hpp"

namespace orchard::pose {
namespace {

PoseConfig config_of(PriorStart start = PriorStart::kGlobal,
                     const Eigen::Vector3d& T = Eigen::Vector3d::Zero()) {
  PoseConfig config;
  config.mode = PoseMode::kPriorMap;
  config.prior_map.start = start;
  config.prior_map.start_x_m = T.x();
  config.prior_map.start_y_m = T.y();
  config.prior_map.start_yaw_rad = T.z();
  return config;
}

/// What became of a drive.
struct Outcome {
  double found_m = -1.0;  ///< driven until the first pose
  double lost_m = -1.0;   ///< driven until the last pose went
  double worst_m = 0.0;   ///< of all poses given
  double rmse_m = 0.0;
  double rmse_rad = 0.0;
  int num_poses = 0;
  std::vector<std::string> warnings;  ///< distinct, in order
  PoseEstimate last;

  bool warned(const std::string& word) const {
    for (const std::string& warning : warnings) {
      if (warning.find(word) != std::string::npos) return true;
    }
    return false;
  }
};

Outcome run(PriorMapLocaliser& localiser, const PriorWorld& world,
            const std::vector<Stretch>& stretches, std::uint64_t seed,
            const PriorDriveOptions& options = {}, double judged_from_m = 0.0) {
  Outcome outcome;
  drive(
      world, way_through(world), stretches, seed, options,
      [&](const Measurement& m, const Eigen::Vector3d& T, double driven_m) {
        localiser.add(m);
        const std::string warning = localiser.warning();
        if (!warning.empty() && (outcome.warnings.empty() || outcome.warnings.back() != warning)) {
          outcome.warnings.push_back(warning);
        }
        const auto estimate = localiser.estimate();
        if (!estimate) {
          if (outcome.num_poses > 0 && outcome.lost_m < 0.0) outcome.lost_m = driven_m;
          return true;
        }
        for (const double value : estimate->covariance) EXPECT_TRUE(std::isfinite(value));
        EXPECT_GT(estimate->covariance[0], 0.0);
        if (outcome.found_m < 0.0) outcome.found_m = driven_m;
        outcome.last = *estimate;
        if (driven_m < judged_from_m) return true;
        const double error_m = std::hypot(estimate->x_m - T.x(), estimate->y_m - T.y());
        const double error_rad = geometry::wrap_angle_rad(estimate->yaw_rad - T.z());
        outcome.worst_m = std::max(outcome.worst_m, error_m);
        outcome.rmse_m += error_m * error_m;
        outcome.rmse_rad += error_rad * error_rad;
        ++outcome.num_poses;
        return true;
      });
  outcome.rmse_m = std::sqrt(outcome.rmse_m / std::max(1, outcome.num_poses));
  outcome.rmse_rad = std::sqrt(outcome.rmse_rad / std::max(1, outcome.num_poses));
  return outcome;
}

PriorWorldOptions small() {
  PriorWorldOptions options;
  options.num_rows = 5;
  options.trees_per_row = 14;
  return options;
}

TEST(PriorMapLocaliser, FollowsADriveThroughAlleysAndHeadlands) {
  const PriorWorld world = prior_world(1, small());
  PriorMapLocaliser localiser(config_of(PriorStart::kGiven, way_through(world).front()),
                              mapped(world, 1));
  const Outcome outcome = run(localiser, changed(world, 1, 0.05), {{0.0, 170.0}}, 1, {}, 1.0);
  EXPECT_LT(outcome.rmse_m, 0.06);
  EXPECT_LT(outcome.rmse_rad, 0.6 * geometry::kPi / 180.0);
  EXPECT_EQ(localiser.num_lost(), 0);
  // The start is stated, not known: it holds once the trunks have told it.
  for (const std::string& warning : outcome.warnings) {
    EXPECT_EQ(warning.find("UNCONFIRMED"), 0u) << warning;
  }
  EXPECT_EQ(localiser.warning(), "");
}

TEST(PriorMapLocaliser, FindsItsPlaceFromNothing) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const PriorWorld world = prior_world(seed, small());
    PriorMapLocaliser localiser(config_of(), mapped(world, seed));
    const double from_m = 25.0 * static_cast<double>(seed);
    const bool back = seed % 2 == 0;
    const Outcome outcome =
        run(localiser, changed(world, seed, 0.05),
            {back ? Stretch{from_m + 25.0, from_m} : Stretch{from_m, from_m + 25.0}}, seed);
    EXPECT_GT(outcome.found_m, 0.0) << seed;
    EXPECT_LT(outcome.worst_m, 0.3) << seed;
    EXPECT_TRUE(outcome.warned("LOST")) << seed;
  }
}

TEST(PriorMapLocaliser, FindsItsPlaceInAislesSixTimesAsWideAsItsTreesStandApart) {
  PriorWorldOptions options = small();
  options.trees_per_row = 30;
  options.row_spacing_m = 6.0;
  options.tree_spacing_m = 1.0;
  options.jitter_m = 0.05;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const PriorWorld world = prior_world(seed, options);
    PriorMapLocaliser localiser(config_of(), mapped(world, seed));
    const double from_m = 25.0 * static_cast<double>(seed);
    const Outcome outcome =
        run(localiser, changed(world, seed, 0.05), {{from_m, from_m + 10.0}}, seed);
    EXPECT_GT(outcome.found_m, 0.0) << seed;
    EXPECT_LT(outcome.worst_m, 0.3) << seed;
  }
}

TEST(PriorMapLocaliser, RowsThatObservationAlikeAreAmbiguousAndGiveNoPose) {
  PriorWorldOptions options = small();
  options.jitter_m = options.missing_fraction = options.width_sd_m = 0.0;
  const PriorWorld world = prior_world(1, options);
  PriorMapLocaliser localiser(config_of(), world.trees);
  const Outcome outcome = run(localiser, world, {{10.0, 32.0}}, 1);
  EXPECT_EQ(outcome.num_poses, 0);
  EXPECT_TRUE(outcome.warned("AMBIGUOUS"));
  EXPECT_TRUE(localiser.warning().find("AMBIGUOUS") == 0) << localiser.warning();
}

TEST(PriorMapLocaliser, TwoEqualHalvesOfAnOrchardAreAmbiguousUntilSomethingTells) {
  // the second two rows repeat the first two; beyond the 20th metre they do not
  PriorWorldOptions options = small();
  options.num_rows = 2;
  const PriorWorld half = prior_world(5, options);
  PriorWorld world = half;
  world.num_rows = 4;
  const auto other = prior_world(6, options).trees;
  for (const PriorLandmark& tree : half.trees) {
    if (tree.p_map.x() > 20.0) continue;
    PriorLandmark twin = tree;
    twin.p_map.y() += 8.0;
    world.trees.push_back(twin);
  }
  for (PriorLandmark tree : other) {
    tree.p_map.y() += 8.0;
    if (tree.p_map.x() > 20.0) world.trees.push_back(tree);
  }
  PriorMapLocaliser localiser(config_of(), mapped(world, 1, 0.02));
  const Outcome outcome = run(localiser, world, {{2.0, 38.0}}, 3);
  EXPECT_TRUE(outcome.warned("AMBIGUOUS"));
  // 3 m of headland and 5.6 m of observation: nothing can tell before 17 m
  EXPECT_GT(outcome.found_m, 15.0);
  EXPECT_LT(outcome.worst_m, 0.3);
}

TEST(PriorMapLocaliser, AnotherOrchardsMapGivesNoPose) {
  // The tenth fits along one row for 50 m.
  for (const std::uint64_t seed : {1, 2, 10, 17}) {
    const PriorWorld world = prior_world(seed, small());
    PriorMapLocaliser localiser(config_of(), mapped(prior_world(seed + 76, small()), seed));
    const Outcome outcome = run(localiser, world, {{5.0, 80.0}}, seed);
    EXPECT_EQ(outcome.num_poses, 0) << seed;
    EXPECT_TRUE(outcome.warned("LOST")) << seed;
  }
}

TEST(PriorMapLocaliser, AWrongStartIsNoticedAndMended) {
  const PriorWorld world = prior_world(1, small());
  // given: one alley further
  Eigen::Vector3d T = way_through(world).front();
  T.y() += 4.0;
  PriorMapLocaliser localiser(config_of(PriorStart::kGiven, T), mapped(world, 1));
  const Outcome outcome = run(localiser, world, {{0.0, 35.0}}, 1, {}, 25.0);
  EXPECT_GE(localiser.num_lost(), 1);
  EXPECT_TRUE(outcome.warned("UNCONFIRMED"));
  EXPECT_TRUE(outcome.warned("LOST") || outcome.warned("AMBIGUOUS"));
  ASSERT_GT(outcome.num_poses, 0);
  EXPECT_LT(outcome.worst_m, 0.3);
}

TEST(PriorMapLocaliser, CarriedToAnotherRowItIsLostAndFindsItselfAgain) {
  const PriorWorld world = prior_world(2, small());
  PriorMapLocaliser localiser(config_of(PriorStart::kGiven, way_through(world).front()),
                              mapped(world, 2));
  // first alley, then backwards down the third (each is 44.8 m with its turn)
  const Outcome outcome =
      run(localiser, changed(world, 2, 0.05), {{0.0, 20.0}, {118.0, 98.0}}, 2, {}, 35.0);
  EXPECT_GE(localiser.num_lost(), 1);
  ASSERT_GT(outcome.num_poses, 0);
  EXPECT_LT(outcome.worst_m, 0.3);
}

TEST(PriorMapLocaliser, CarriedByWholeTreeSpacingsItNoticesSoonAndKeepsWhatItSawSince) {
  // to the third alley, where trees stand as those that it would see had it not been carried
  const double third_m = 2.0 * (13 * 2.5 + 6.0 + 2.0 * geometry::kPi);
  // by the check of all trunks of the way alone these take 5 to 9 m to be noticed
  for (const std::uint64_t seed : {1004, 1019, 1038, 1040, 1041}) {
    const PriorWorld world = prior_world(seed, small());
    PriorMapLocaliser localiser(config_of(PriorStart::kGiven, way_through(world).front()),
                                mapped(world, seed));
    const Outcome outcome = run(localiser, changed(world, seed, 0.05),
                                {{0.0, 20.0}, {third_m + 10.0, third_m + 21.0}}, seed, {}, 30.0);
    EXPECT_GE(localiser.num_lost(), 1) << seed;
    EXPECT_LT(outcome.lost_m, 24.0) << seed;
    // In the first, the trees that are missing at the last place are noticed before.
    EXPECT_TRUE(outcome.warned("may have been carried") ||
                outcome.warned("trees expected at the last place"))
        << seed;
    EXPECT_GT(outcome.num_poses, 0) << seed << ": " << localiser.warning();
    EXPECT_LT(outcome.worst_m, 0.3) << seed;
  }
}

TEST(PriorMapLocaliser, FindsItsPlaceWhereManyTreesHaveChanged) {
  for (std::uint64_t seed = 1001; seed <= 1006; ++seed) {
    const PriorWorld world = prior_world(seed, small());
    PriorMapLocaliser localiser(config_of(), mapped(world, seed));
    const Outcome outcome = run(localiser, changed(world, seed, 0.15), {{5.0, 20.0}}, seed);
    EXPECT_GT(outcome.found_m, 0.0) << seed << ": " << localiser.warning();
    EXPECT_LT(outcome.worst_m, 0.3) << seed;
  }
}

TEST(PriorMapLocaliser, TenSecondsWithoutOdometryAreSaidAndSurvived) {
  const PriorWorld world = prior_world(3, small());
  PriorMapLocaliser localiser(config_of(PriorStart::kGiven, way_through(world).front()),
                              mapped(world, 3));
  PriorDriveOptions options;
  options.silent_from_s = 12.0;
  options.silent_to_s = 22.0;
  const Outcome outcome = run(localiser, world, {{0.0, 34.0}}, 3, options, 1.0);
  EXPECT_TRUE(outcome.warned("no ODOMETRY"));
  EXPECT_TRUE(localiser.warning().empty()) << localiser.warning();
  EXPECT_LT(outcome.worst_m, 0.5);
}

TEST(PriorMapLocaliser, NoBadNumberAndNoJumpOfTimeBringsItDown) {
  const PriorWorld world = prior_world(3, small());
  PriorMapLocaliser localiser(config_of(PriorStart::kGiven, way_through(world).front()),
                              mapped(world, 3));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Outcome before = run(localiser, world, {{0.0, 10.0}}, 3);
  ASSERT_TRUE(localiser.estimate());
  const PoseEstimate pose = *localiser.estimate();
  Odometry odometry;
  odometry.utime = pose.utime + 20000;
  odometry.speed_mps = nan;
  localiser.add(Measurement(odometry));
  odometry.speed_mps = 1.0;
  odometry.utime = pose.utime - 5'000'000;  // backwards
  localiser.add(Measurement(odometry));
  detection::Detections seen;
  seen.utime = pose.utime + 20000;
  detection::Detection trunk;
  trunk.utime = seen.utime;
  trunk.centre_x_m = nan;
  seen.trunks.assign(5, trunk);
  localiser.add(Measurement(seen));
  ASSERT_TRUE(localiser.estimate());
  EXPECT_NEAR(localiser.estimate()->x_m, pose.x_m, 0.1);
  // a year ahead
  odometry.utime = pose.utime + 31'000'000'000'000;
  localiser.add(Measurement(odometry));
  seen.utime = odometry.utime + 1;
  localiser.add(Measurement(seen));
  EXPECT_FALSE(localiser.estimate()) << "nobody knows where it is after a year";
  EXPECT_NE(localiser.warning().find("LOST"), std::string::npos);
}

TEST(PriorMapLocaliser, TheSameInputGivesTheSameBits) {
  const PriorWorld world = prior_world(4, small());
  std::vector<PoseEstimate> ends;
  for (int i = 0; i < 2; ++i) {
    PriorMapLocaliser localiser(config_of(), mapped(world, 4));
    ends.push_back(run(localiser, changed(world, 4, 0.05), {{5.0, 30.0}}, 4).last);
  }
  EXPECT_GT(ends[0].utime, 0);
  EXPECT_EQ(ends[0].utime, ends[1].utime);
  EXPECT_EQ(ends[0].x_m, ends[1].x_m);
  EXPECT_EQ(ends[0].covariance, ends[1].covariance);
}

TEST(PriorMapLocaliser, RefusesAMapThatNobodyCanGoBy) {
  EXPECT_THROW(PriorMapLocaliser(config_of(), {}), std::invalid_argument);
  EXPECT_THROW(make_localiser(config_of()), std::invalid_argument);
}

/// What a detector would make of a scan at T_map_base: every trunk within 6 m.
detection::Detections trunks_seen(const CastWorld& world, std::int64_t utime,
                                  const Eigen::Vector3d& T_map_base) {
  detection::Detections seen;
  seen.utime = utime;
  for (const CastWorld::Circle& trunk : world.circles) {
    const Eigen::Vector2d p_base = geometry::inverse_transform(T_map_base, trunk.centre);
    if (p_base.norm() > 6.0) continue;
    detection::Detection d;
    d.utime = utime;
    d.centre_x_m = p_base.x();
    d.centre_y_m = p_base.y();
    d.width_m = 2.0 * trunk.radius_m;
    d.width_sd_m = 0.01;
    d.covariance = {1e-4, 0.0, 1e-4};
    seen.trunks.push_back(d);
  }
  return seen;
}

TEST(PriorMapLocaliser, FindsAndFollowsByScansInsteadOfWheels) {
  const PriorWorld world = prior_world(21);
  CastWorld cast;
  for (const PriorLandmark& tree : world.trees) {
    cast.circles.push_back({tree.p_map, 0.5 * tree.width_m});
  }
  PoseConfig config = config_of();
  config.motion = MotionSource::kScans;
  PriorMapLocaliser localiser(config, mapped(world, 21));
  const std::vector<Eigen::Vector3d> way = way_through(world);
  std::mt19937 noise(21);
  int num_poses = 0;
  double worst_m = 0.0;
  const std::size_t step = 12;  // a scan every 0.24 m
  for (std::size_t i = 0; i < 200; ++i) {
    // stretched time: ten seconds from scan to scan
    const auto utime = static_cast<std::int64_t>(i) * 10'000'000;
    const Eigen::Vector3d& T = way[500 + step * i];
    localiser.add(Measurement(Odometry{}));  // of no use here
    localiser.add(Measurement(cast.scan(utime, T, &noise, 0.01)));
    localiser.add(Measurement(trunks_seen(cast, utime, T)));
    const std::optional<PoseEstimate> pose = localiser.estimate();
    if (!pose) continue;
    ++num_poses;
    EXPECT_EQ(pose->utime, utime);
    worst_m = std::max(worst_m, std::hypot(pose->x_m - T.x(), pose->y_m - T.y()));
  }
  EXPECT_GT(num_poses, 120);
  EXPECT_LT(worst_m, 0.15);
  EXPECT_EQ(localiser.num_lost(), 0);

  // A scan that meets nothing tells no motion, so the place is vague: both are said.
  config = config_of(PriorStart::kGiven, way[500]);
  config.motion = MotionSource::kScans;
  PriorMapLocaliser stated(config, mapped(world, 21));
  for (std::int64_t i = 0; i < 2; ++i) {
    laser::Scan scan = cast.scan(i * 100'000, way[500], &noise, 0.01);
    if (i > 0) std::fill(scan.ranges_m.begin(), scan.ranges_m.end(), 0.0F);
    stated.add(Measurement(scan));
    stated.add(Measurement(trunks_seen(cast, scan.utime, way[500])));
  }
  EXPECT_EQ(stated.warning().find("AMBIGUOUS"), 0u) << stated.warning();
  EXPECT_NE(stated.warning().find("; the last scan could not be matched"), std::string::npos)
      << stated.warning();
}

TEST(PriorMapLocaliser, WaitsForTheNextScanWhenTheWheelsContradictOne) {
  // One scan in between shows what is seen from 1.2 m farther on.
  const PriorWorld world = prior_world(21);
  CastWorld cast;
  for (const PriorLandmark& tree : world.trees) {
    cast.circles.push_back({tree.p_map, 0.5 * tree.width_m});
  }
  const std::vector<Eigen::Vector3d> way = way_through(world);
  PoseConfig config = config_of(PriorStart::kGiven, way[500]);
  config.motion = MotionSource::kScans;
  PriorMapLocaliser localiser(config, mapped(world, 21));
  std::mt19937 noise(21);
  std::size_t at = 500;
  for (int i = 0; i < 40; ++i, at += 12) {
    const std::int64_t utime = i * 100'000;
    if (i > 0) {
      const Eigen::Vector3d step = geometry::between(way[at - 12], way[at]);
      Odometry odometry;
      odometry.utime = utime;
      odometry.seq = i;
      odometry.speed_mps = 10.0 * step.x();
      odometry.yaw_rate_radps = 10.0 * step.z();
      localiser.add(Measurement(odometry));
    }
    const Eigen::Vector3d& T = way[i == 30 ? at + 60 : at];
    localiser.add(Measurement(cast.scan(utime, T, &noise, 0.01)));
    localiser.add(Measurement(trunks_seen(cast, utime, T)));
    const std::optional<PoseEstimate> pose = localiser.estimate();
    if (i < 20) continue;
    ASSERT_TRUE(pose) << i;
    EXPECT_EQ(pose->utime, i == 30 ? utime - 100'000 : utime);
    const Eigen::Vector3d& told = way[i == 30 ? at - 12 : at];
    EXPECT_LT(std::hypot(pose->x_m - told.x(), pose->y_m - told.y()), 0.15) << i;
    EXPECT_EQ(localiser.warning().find("the last scan could not be matched") != std::string::npos,
              i == 30)
        << i << localiser.warning();
  }
}

// A reading of the wheels is the mean since the one before, for whoever integrates it.

constexpr double kPeriod_s = 0.1;
constexpr double kAcceleration_mps2 = 0.9;

std::int64_t utime_at(double t_s) { return 1 + std::llround(1e6 * t_s); }

/// Way of a robot that speeds up from 1.03 s to 3.27 s and goes on at that speed.
double way_at(double t_s) {
  const double up_s = std::clamp(t_s, 1.03, 3.27) - 1.03;
  return kAcceleration_mps2 * (0.5 * up_s * up_s + up_s * std::max(0.0, t_s - 3.27));
}

/// Heading of one that stands, and turns likewise.
Odometry reading(int i, bool turns) {
  const double mean = (way_at(i * kPeriod_s) - way_at((i - 1) * kPeriod_s)) / kPeriod_s;
  Odometry odometry;
  odometry.utime = utime_at(i * kPeriod_s);
  (turns ? odometry.yaw_rate_radps : odometry.speed_mps) = mean;
  return odometry;
}

void follows(const std::function<std::unique_ptr<Localiser>()>& make) {
  for (const bool turns : {false, true}) {
    const auto localiser = make();
    for (int i = 0; i <= 45; ++i) {
      localiser->add(Measurement(reading(i, turns)));
      const auto pose = localiser->estimate();
      if (!pose) continue;
      const double way = way_at(i * kPeriod_s);
      EXPECT_NEAR(turns ? pose->yaw_rad : pose->x_m, turns ? std::remainder(way, 2.0 * M_PI) : way,
                  1e-6)
          << i;
    }
    ASSERT_TRUE(localiser->estimate());
  }
}

TEST(WheelReading, OfModeOdometry) {
  PoseConfig config;
  config.mode = PoseMode::kOdometry;
  follows([&] { return make_localiser(config); });
}

TEST(WheelReading, OfModeFused) {
  PoseConfig config;
  config.mode = PoseMode::kFused;
  config.fusion.use_gnss = config.fusion.use_fixes = false;
  follows([&] { return std::make_unique<Fusion>(config); });
}

TEST(WheelReading, OfModePriorMap) {
  PoseConfig config;
  config.mode = PoseMode::kPriorMap;
  config.prior_map.start = PriorStart::kGiven;
  const PriorWorld world = prior_world(3, {});
  follows([&] { return std::make_unique<PriorMapLocaliser>(config, mapped(world, 3)); });
}

// Back from the first fix, as the wheels came there.
TEST(WheelReading, OfTheWayBeforeTheFirstFix) {
  PoseConfig config;
  config.mode = PoseMode::kFixesAndOdometry;
  const auto estimator = make_localiser(config);
  for (int i = 0; i <= 45; ++i) estimator->add(Measurement(reading(i, false)));
  PoseFix fix;
  fix.utime = utime_at(45 * kPeriod_s);
  fix.x_m = way_at(45 * kPeriod_s);
  estimator->add(Measurement(fix));
  const auto past = estimator->take_past_poses();
  ASSERT_EQ(past.size(), 45u);
  for (int i = 0; i < 45; ++i) EXPECT_NEAR(past[i].x_m, way_at(i * kPeriod_s), 1e-6) << i;
}

}  // namespace
}  // namespace orchard::pose
