// SPDX-License-Identifier: BSD-3-Clause
// Truth: a drive of straights and bends integrated in small steps; sensors made from it with the
// errors that each test names, GNSS by GeographicLib's inverse of what the filter uses.
#include "pose/filter/fusion.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <GeographicLib/LocalCartesian.hpp>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "geometry/angles.hpp"
#include "unit/nees_band.hpp"

namespace orchard::pose {
namespace {

constexpr std::array<double, 3> kDatum{-27.6, 151.9, 600.0};
constexpr std::int64_t kStart_us = 1700000000000000;

struct Truth {
  double time_s;
  double x_m, y_m, yaw_rad;
  double speed_mps, yaw_rate_radps;
};

/// Up and down rows of 40 m with half circles of 2 m radius between them, at 1 m/s; `heading_rad`
/// at the start.
std::vector<Truth> drive(double duration_s, double heading_rad) {
  std::vector<Truth> truth;
  Truth t{0.0, 5.0, -3.0, heading_rad, 1.0, 0.0};
  const double bend_s = geometry::kPi * 2.0;
  constexpr double kDt_s = 0.01;
  for (int i = 0; i * kDt_s <= duration_s; ++i) {
    t.time_s = i * kDt_s;
    const double lap_s = std::fmod(t.time_s, 2.0 * (40.0 + bend_s));
    const bool left = lap_s < 40.0 + bend_s;
    const bool bends = std::fmod(lap_s, 40.0 + bend_s) > 40.0;
    t.yaw_rate_radps = bends ? (left ? 0.5 : -0.5) : 0.0;
    truth.push_back(t);
    t.x_m += std::cos(t.yaw_rad + 0.5 * t.yaw_rate_radps * kDt_s) * kDt_s;
    t.y_m += std::sin(t.yaw_rad + 0.5 * t.yaw_rate_radps * kDt_s) * kDt_s;
    t.yaw_rad += t.yaw_rate_radps * kDt_s;
  }
  return truth;
}

struct Errors {
  double speed_scale = 0.0;
  double turn_scale = 0.0;
  double curvature_per_m = 0.0;
  std::function<double(double)> curvature_besides_per_m = [](double) { return 0.0; };
  std::function<double(double)> turn_besides = [](double) { return 0.0; };
  double speed_sd_mps = 0.01;
  double yaw_rate_sd_radps = 0.01;
  double gnss_sd_m = 0.02;
  double gnss_stated_sd_m = 0.02;
  double gyro_bias_radps = 0.0;
  double gyro_sd_radps = 0.002;
  bool has_imu = false;
  std::function<bool(double)> has_odometry = [](double) { return true; };
  std::function<bool(double)> has_gnss = [](double) { return true; };
  std::function<Eigen::Vector2d(double)> gnss_offset_m = [](double) {
    return Eigen::Vector2d(0.0, 0.0);
  };
  std::function<bool(double)> gnss_frozen = [](double) { return false; };
};

struct Outcome {
  double rmse_m = 0.0;
  double worst_m = 0.0;
  double yaw_rmse_rad = 0.0;
  double nees = 0.0;                               ///< of the last pose; 3 on average
  std::vector<std::pair<double, double>> error_m;  ///< time [s], error
  std::vector<std::string> warnings;               ///< each new one, in order
  std::string final_warning;
  std::int64_t last_utime = 0;
  Eigen::Vector3d sensor_errors;

  bool warned(const std::string& part) const {
    for (const std::string& w : warnings) {
      if (w.find(part) != std::string::npos) return true;
    }
    return false;
  }
  double worst_within(double from_s, double to_s) const {
    double worst = 0.0;
    for (const auto& [time_s, e] : error_m) {
      if (time_s >= from_s && time_s <= to_s) worst = std::max(worst, e);
    }
    return worst;
  }
};

PoseConfig config_of() {
  PoseConfig config;
  config.mode = PoseMode::kFused;
  config.heading_baseline_m = 3.0;
  config.gnss.datum = kDatum;
  config.gnss.antenna_m = {-0.4, 0.25};
  return config;
}

Outcome run(const PoseConfig& config, const Errors& errors, std::uint64_t seed,
            double duration_s = 300.0, double count_from_s = 30.0) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const GeographicLib::LocalCartesian enu(kDatum[0], kDatum[1], kDatum[2]);
  Fusion fusion(config);
  Outcome result;
  Gnss last_gnss;
  double sum2 = 0.0, yaw_sum2 = 0.0;
  int count = 0;
  const std::vector<Truth> truth = drive(duration_s, 0.7);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Truth& t = truth[i];
    const std::int64_t utime = kStart_us + std::llround(1e6 * t.time_s);
    if (errors.has_imu) {
      Imu imu;
      imu.utime = utime;
      imu.angular_rate_radps[2] =
          t.yaw_rate_radps + errors.gyro_bias_radps + errors.gyro_sd_radps * normal(random);
      imu.acceleration_mps2[2] = 9.8;
      fusion.add(Measurement(imu));
    }
    if (i % 2 == 0 && errors.has_odometry(t.time_s)) {
      Odometry odometry;
      odometry.utime = utime;
      odometry.speed_mps =
          t.speed_mps / (1.0 + errors.speed_scale) + errors.speed_sd_mps * normal(random);
      const double curvature_per_m =
          errors.curvature_per_m + errors.curvature_besides_per_m(t.time_s);
      odometry.yaw_rate_radps =
          t.yaw_rate_radps / (1.0 + errors.turn_scale + errors.turn_besides(t.time_s)) -
          curvature_per_m * t.speed_mps + errors.yaw_rate_sd_radps * normal(random);
      fusion.add(Measurement(odometry));
    }
    if (i % 20 == 0 && errors.has_gnss(t.time_s)) {
      const double c = std::cos(t.yaw_rad), s = std::sin(t.yaw_rad);
      const auto& a = config.gnss.antenna_m;
      const Eigen::Vector2d offset_m = errors.gnss_offset_m(t.time_s);
      const double east_m =
          t.x_m + c * a[0] - s * a[1] + errors.gnss_sd_m * normal(random) + offset_m.x();
      const double north_m =
          t.y_m + s * a[0] + c * a[1] + errors.gnss_sd_m * normal(random) + offset_m.y();
      Gnss gnss;
      enu.Reverse(east_m, north_m, 1.5, gnss.latitude_deg, gnss.longitude_deg, gnss.altitude_m);
      if (errors.gnss_frozen(t.time_s)) gnss = last_gnss;
      last_gnss = gnss;
      gnss.utime = utime;
      gnss.fix_quality = 4;
      const double variance = errors.gnss_stated_sd_m * errors.gnss_stated_sd_m;
      gnss.covariance = {variance, 0, 0, variance, 0, 4 * variance};
      fusion.add(Measurement(gnss));
    }
    const std::string warning = fusion.warning();
    if (!warning.empty() && (result.warnings.empty() || result.warnings.back() != warning)) {
      result.warnings.push_back(warning);
    }
    const auto estimate = fusion.estimate();
    if (!estimate || estimate->utime != utime) continue;
    EXPECT_GE(estimate->utime, result.last_utime);
    result.last_utime = estimate->utime;
    if (t.time_s < count_from_s) continue;
    Eigen::Vector3d e(estimate->x_m - t.x_m, estimate->y_m - t.y_m,
                      geometry::wrap_angle_rad(estimate->yaw_rad - t.yaw_rad));
    const auto& P = estimate->covariance;
    Eigen::Matrix3d covariance;
    covariance << P[0], P[1], P[2], P[1], P[3], P[4], P[2], P[4], P[5];
    EXPECT_TRUE(e.allFinite() && covariance.allFinite());
    const double error_m = e.head<2>().norm();
    result.error_m.emplace_back(t.time_s, error_m);
    result.worst_m = std::max(result.worst_m, error_m);
    sum2 += error_m * error_m;
    yaw_sum2 += e.z() * e.z();
    result.nees = e.dot(covariance.inverse() * e);
    ++count;
  }
  fusion.finish();
  result.final_warning = fusion.warning();
  for (const Finding& finding : fusion.findings()) result.final_warning += finding.text;
  result.rmse_m = std::sqrt(sum2 / count);
  result.yaw_rmse_rad = std::sqrt(yaw_sum2 / count);
  result.sensor_errors = fusion.sensor_errors();
  return result;
}

TEST(Fusion, FindsTheWaysOfWheelsAndAntenna) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Errors errors;
    errors.speed_scale = 0.03;
    errors.curvature_per_m = 0.01;
    const Outcome r = run(config_of(), errors, seed);
    EXPECT_LT(r.rmse_m, 0.02) << "seed " << seed;
    EXPECT_LT(r.yaw_rmse_rad, 0.01);
    EXPECT_NEAR(r.sensor_errors(0), 0.03, 0.004);
    EXPECT_NEAR(r.sensor_errors(1), 0.01, 0.002);
    EXPECT_EQ(r.final_warning, "");
  }
}

// Over 40 seeds NEES is 1.3 of 3 with a band of 2.3 to 3.8: the filter takes errors of speed and
// yaw rate to last 0.1 s, and here each reading errs by itself. Only its upper limit is the band's.
TEST(Fusion, IsSurerThanItSaysOfReadingsThatErrByThemselves) {
  double nees = 0.0;
  constexpr int kRuns = 10;
  for (int seed = 1; seed <= kRuns; ++seed) {
    Errors errors;
    errors.speed_scale = seed % 2 == 0 ? 0.02 : -0.03;
    errors.curvature_per_m = 0.002 * (seed - 5);
    nees += run(config_of(), errors, 100 + static_cast<std::uint64_t>(seed)).nees / kRuns;
  }
  EXPECT_GT(nees, 0.8);
  EXPECT_LT(nees, test::nees_band(3, kRuns).most);
}

TEST(Fusion, TheGyroBridgesAnOutage) {
  Errors errors;
  errors.speed_scale = 0.03;
  errors.yaw_rate_sd_radps = 0.05;
  errors.gyro_bias_radps = 0.015;
  errors.has_gnss = [](double time_s) { return time_s < 150.0 || time_s > 210.0; };
  PoseConfig config = config_of();
  const Outcome wheels = run(config, errors, 7);
  errors.has_imu = true;
  config.fusion.use_imu = true;
  const Outcome gyro = run(config, errors, 7);
  EXPECT_NEAR(gyro.sensor_errors(2), 0.015, 0.002);
  EXPECT_LT(gyro.worst_within(150.0, 210.0), 1.0);
  EXPECT_LT(gyro.worst_within(150.0, 210.0), wheels.worst_within(150.0, 210.0));
  EXPECT_LT(gyro.worst_within(215.0, 300.0), 0.1);
}

TEST(Fusion, WheelsThatTellTurnsShortBridgeAGap) {
  Errors errors;
  errors.turn_scale = 0.15;
  errors.has_gnss = [](double time_s) { return time_s < 250.0 || time_s > 340.0; };
  // Two half circles in the gap: by the turns as told the heading would be 0.8 rad off behind them.
  const Outcome r = run(config_of(), errors, 8, 400.0);
  EXPECT_LT(r.worst_within(250.0, 340.0), 3.0);
  EXPECT_LT(r.worst_within(345.0, 400.0), 0.1);
}

TEST(Fusion, FixesBehindAGapAreBelievedAtOnce) {
  Errors errors;
  // A tyre that loses its air in the gap: nothing before tells of it.
  errors.curvature_besides_per_m = [](double time_s) { return time_s > 155.0 ? 0.04 : 0.0; };
  errors.has_gnss = [](double time_s) { return time_s < 150.0 || time_s > 210.0; };
  const Outcome r = run(config_of(), errors, 9, 300.0);
  EXPECT_GT(r.worst_within(150.0, 210.0), 10.0);
  EXPECT_LT(r.worst_within(210.3, 300.0), 2.0);
  EXPECT_LT(r.worst_within(235.0, 300.0), 0.2);
}

TEST(Fusion, GroundThatSlipsInTurnsIsReckonedWithInAGap) {
  // Slip in turns of 5 %, which the ground changes every 10 m: in a gap with five half circles the
  // heading is off by tenths of a radian, as the drive before has shown.
  double nees = 0.0;
  constexpr int kRuns = 4;
  for (int seed = 1; seed <= kRuns; ++seed) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    std::normal_distribution<double> normal(0.0, 0.05);
    std::vector<double> slips;
    for (int i = 0; i < 100; ++i) slips.push_back(normal(random));
    Errors errors;
    errors.gnss_sd_m = errors.gnss_stated_sd_m = 0.5;
    errors.turn_besides = [&](double time_s) {
      return slips[static_cast<std::size_t>(time_s / 10.0) % slips.size()];
    };
    errors.has_gnss = [](double time_s) { return time_s < 500.0; };
    nees += run(config_of(), errors, 20 + static_cast<std::uint64_t>(seed), 740.0, 700.0).nees;
  }
  const auto band = test::nees_band(3, kRuns);
  EXPECT_GT(nees / kRuns, band.least);
  EXPECT_LT(nees / kRuns, band.most);
}

TEST(Fusion, AReflectedStartIsFoundOut) {
  Errors errors;
  errors.gnss_sd_m = 0.5;
  errors.gnss_stated_sd_m = 1.7;
  errors.gnss_offset_m = [](double time_s) {
    return time_s > 1.5 && time_s < 20.0 ? Eigen::Vector2d(-16.0, 27.0) : Eigen::Vector2d(0, 0);
  };
  const Outcome r = run(config_of(), errors, 10, 100.0);
  EXPECT_LT(r.worst_within(30.0, 100.0), 2.0);
  EXPECT_NE(r.final_warning.find("rejected"), std::string::npos);
}

TEST(Fusion, AGapSoonAfterTheStartIsGotOver) {
  Errors errors;
  errors.speed_scale = 0.05;
  errors.curvature_per_m = 0.01;
  errors.gnss_sd_m = 0.5;
  errors.gnss_stated_sd_m = 1.7;
  errors.has_gnss = [](double time_s) { return time_s < 3.0 || time_s > 120.0; };
  const Outcome r = run(config_of(), errors, 11, 200.0, 120.0);
  EXPECT_LT(r.worst_within(125.0, 200.0), 2.0);
  EXPECT_LT(r.nees, test::nees_band(3, 1).most);
}

TEST(Fusion, AJumpOf30mIsLeftOutAndNamed) {
  Errors errors;
  errors.gnss_offset_m = [](double time_s) {
    return time_s > 100.0 && time_s < 110.0 ? Eigen::Vector2d(30.0, 0.0) : Eigen::Vector2d(0, 0);
  };
  const Outcome r = run(config_of(), errors, 3);
  EXPECT_LT(r.worst_m, 0.3);
  EXPECT_TRUE(r.warned("GNSS is 30.")) << r.final_warning;
  EXPECT_NE(r.final_warning.find("rejected"), std::string::npos);
}

TEST(Fusion, AReceiverThatStaysElsewhereIsFollowedInTheEnd) {
  Errors errors;
  errors.gnss_offset_m = [](double time_s) {
    return time_s > 100.0 ? Eigen::Vector2d(5.0, 0.0) : Eigen::Vector2d(0, 0);
  };
  const Outcome r = run(config_of(), errors, 3);
  EXPECT_LT(r.worst_within(100.0, 110.0), 0.5);
  EXPECT_NEAR(r.worst_within(140.0, 300.0), 5.0, 0.3);
}

TEST(Fusion, AFrozenReceiverIsLeftOutAndNamed) {
  Errors errors;
  errors.gnss_frozen = [](double time_s) { return time_s > 100.0 && time_s < 115.0; };
  const Outcome r = run(config_of(), errors, 4);
  EXPECT_LT(r.worst_m, 0.8);
  EXPECT_TRUE(r.warned("frozen"));
  EXPECT_LT(r.worst_within(120.0, 300.0), 0.1);
}

TEST(Fusion, AReceiverThatClaimsAMillimetreIsBelievedAsItScatters) {
  Errors errors;
  errors.gnss_sd_m = 0.5;
  errors.gnss_stated_sd_m = 0.001;
  PoseConfig config = config_of();
  config.heading_baseline_m = 10.0;
  const Outcome r = run(config, errors, 5, 400.0, 100.0);
  EXPECT_TRUE(r.warned("more than it states"));
  EXPECT_LT(r.rmse_m, 0.25);  // better than each fix
  EXPECT_LT(r.nees, test::nees_band(3, 1).most);
}

TEST(Fusion, TenSecondsWithoutWheelsAreNamedAndGotOver) {
  Errors errors;
  errors.has_odometry = [](double time_s) { return time_s < 100.0 || time_s > 110.0; };
  const Outcome r = run(config_of(), errors, 6);
  EXPECT_TRUE(r.warned("no ODOMETRY"));
  // Without a heading, base may lie on the other side of the antenna (0.47 m), and its motion until
  // the next fixes is as uncertain.
  EXPECT_LT(r.worst_within(110.1, 300.0), 1.4);
  EXPECT_LT(r.worst_within(112.0, 300.0), 0.1);
  EXPECT_NE(r.final_warning.find("silent"), std::string::npos);
}

TEST(Fusion, WithoutPositionsItDeadReckonsFromTheOrigin) {
  PoseConfig config = config_of();
  config.fusion.use_gnss = false;
  Fusion fusion(config);
  for (int i = 0; i <= 100; ++i) {
    Odometry odometry;
    odometry.utime = 20000 * i;
    odometry.speed_mps = 1.0;
    fusion.add(Measurement(odometry));
  }
  const auto pose = fusion.estimate();
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->x_m, 2.0, 1e-9);
  EXPECT_NEAR(pose->y_m, 0.0, 1e-9);
  EXPECT_NEAR(std::sqrt(pose->covariance[0]), 0.05 * 2.0, 0.03);  // mostly the doubted scale
}

TEST(Fusion, TimeThatGoesBackIsNotFollowed) {
  PoseConfig config = config_of();
  config.fusion.use_gnss = false;
  Fusion fusion(config);
  for (const std::int64_t utime : {0, 20000, 40000, 10000, 60000}) {
    Odometry odometry;
    odometry.utime = utime;
    odometry.speed_mps = 1.0;
    fusion.add(Measurement(odometry));
  }
  EXPECT_NEAR(fusion.estimate()->x_m, 0.06, 1e-9);
  EXPECT_EQ(fusion.estimate()->utime, 60000);
}

TEST(Fusion, AFixWithAHeadingStartsAtOnce) {
  PoseConfig config = config_of();
  config.fusion.use_gnss = false;
  config.fusion.use_fixes = true;
  Fusion fusion(config);
  PoseFix fix;
  fix.utime = 1000;
  fix.x_m = 3.0;
  fix.yaw_rad = 1.0;
  fix.covariance = {1e-4, 0, 0, 1e-4, 0, 1e-4};
  fusion.add(Measurement(fix));
  ASSERT_TRUE(fusion.estimate());
  EXPECT_DOUBLE_EQ(fusion.estimate()->x_m, 3.0);
  EXPECT_DOUBLE_EQ(fusion.estimate()->yaw_rad, 1.0);
}

}  // namespace
}  // namespace orchard::pose
