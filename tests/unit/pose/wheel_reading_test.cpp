// SPDX-License-Identifier: BSD-3-Clause
// A reading of the wheels is the mean since the one before, for whoever integrates it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "pose/filter/fusion.hpp"
#include "pose/localiser.hpp"
#include "pose/prior_map/prior_map_localiser.hpp"
#include "unit/pose/prior_map/prior_world.hpp"

namespace orchard::pose {
namespace {

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
