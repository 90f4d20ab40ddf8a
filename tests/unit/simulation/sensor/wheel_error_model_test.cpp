// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/sensor/wheel_error_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace orchard::simulation {
namespace {

constexpr OdometryErrors kRun{0.01, 0.002, -0.03};

TEST(WheelErrorModel, LeavesTheRunsErrorsWhereNothingLasts) {
  const WheelErrorModel memory(1, WheelsConfig{}, 100.0);
  const OdometryErrors errors = memory.errors_at(kRun, 12.0, {3.0, 4.0, 0.5});
  EXPECT_EQ(errors.speed_scale, kRun.speed_scale);
  EXPECT_EQ(errors.yaw_rate_bias_radps, kRun.yaw_rate_bias_radps);
  EXPECT_EQ(errors.yaw_rate_scale, kRun.yaw_rate_scale);
}

TEST(WheelErrorModel, SlipBelongsToTheGround) {
  WheelsConfig config;
  config.surface_slip_sd = 0.02;
  config.surface_turn_slip_sd = 0.05;
  const WheelErrorModel memory(7, config, 100.0);
  const auto at = [&](double time_s, double x_m, double y_m) {
    return memory.errors_at({}, time_s, {x_m, y_m, 0.0});
  };
  EXPECT_EQ(at(1.0, 20.0, -7.0).speed_scale, at(99.0, 20.0, -7.0).speed_scale);
  double speed2 = 0.0, turn2 = 0.0, both = 0.0, near = 0.0;
  constexpr int kSide = 40;
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      const double x_m = 37.0 * (i - 20), y_m = 41.0 * (j - 20);
      const OdometryErrors here = at(0.0, x_m, y_m), beside = at(0.0, x_m + 1.0, y_m);
      speed2 += here.speed_scale * here.speed_scale;
      turn2 += here.yaw_rate_scale * here.yaw_rate_scale;
      both += here.speed_scale * here.yaw_rate_scale;
      near += here.speed_scale * beside.speed_scale;
    }
  }
  constexpr double kNum = kSide * kSide;
  EXPECT_NEAR(std::sqrt(speed2 / kNum), 0.02, 0.002);
  EXPECT_NEAR(std::sqrt(turn2 / kNum), 0.05, 0.005);
  EXPECT_NEAR(both / kNum / (0.02 * 0.05), 0.0, 0.1);
  EXPECT_GT(near / speed2, 0.95);  // a metre is little against a patch
}

TEST(WheelErrorModel, TheLoadChangesTheScaleNowAndThen) {
  WheelsConfig config;
  config.load_sd = 0.01;
  config.load_every_s = 100.0;
  const WheelErrorModel memory(3, config, 1000.0);
  const auto scale = [&](double time_s) { return memory.errors_at({}, time_s, {}).speed_scale; };
  EXPECT_EQ(scale(1.0), scale(99.0));
  EXPECT_NE(scale(99.0), scale(101.0));
  EXPECT_EQ(scale(101.0), scale(199.0));
}

TEST(WheelErrorModel, TheBiasWandersByItsStandardDeviationAndTime) {
  WheelsConfig config;
  config.bias_wander_sd_radps = 0.003;
  config.bias_wander_s = 50.0;
  const WheelErrorModel memory(5, config, 100000.0);
  double sum2 = 0.0, later = 0.0;
  int n = 0;
  for (double t_s = 0.0; t_s < 99000.0; t_s += 10.0, ++n) {
    const double bias = memory.errors_at({}, t_s, {}).yaw_rate_bias_radps;
    sum2 += bias * bias;
    later += bias * memory.errors_at({}, t_s + 50.0, {}).yaw_rate_bias_radps;
  }
  EXPECT_NEAR(std::sqrt(sum2 / n), 0.003, 0.0003);
  EXPECT_NEAR(later / sum2, std::exp(-1.0), 0.08);
}

}  // namespace
}  // namespace orchard::simulation
