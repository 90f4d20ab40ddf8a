// SPDX-License-Identifier: BSD-3-Clause

#include <gtest/gtest.h>

#include <GeographicLib/LocalCartesian.hpp>
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "geometry/angles.hpp"
#include "simulation/sensor/motion_sensors.hpp"
#include "simulation/simulator.hpp"
#include "worlds/observation_truth.hpp"

namespace orchard::simulation {
namespace {

constexpr double kPeriod_s = 0.2;  ///< of GNSS

RigConfig block() {
  RigConfig rig;
  rig.camera.enabled = false;
  SimulationConfig& config = rig.simulation;
  config.orchard.num_rows = 4;
  config.orchard.trees_per_row = 10;
  config.orchard.laps = 1;
  config.orchard.fix_rate_hz = 0.0;
  config.scanner.rate_hz = 0.5;
  config.scanner.range_max_m = 15.0;
  config.motion.gnss_rate_hz = 1.0 / kPeriod_s;
  return rig;
}

double seconds(std::int64_t utime) { return static_cast<double>(utime - kEpochUtime) * 1e-6; }

template <class Message>
std::vector<Message> messages_of(Simulator& simulator) {
  std::vector<Message> all;
  while (const auto message = simulator.next()) {
    if (const auto* wanted = std::get_if<Message>(&*message)) all.push_back(*wanted);
  }
  return all;
}

/// Map places of a run's fixes by their time.
struct Fix {
  double time_s, x_m, y_m;
  pose::Gnss gnss;
};

std::vector<Fix> fixes_of(Simulator& simulator, const RigConfig& rig) {
  const auto& datum = rig.simulation.motion.datum;
  const GeographicLib::LocalCartesian enu(datum[0], datum[1], datum[2]);
  std::vector<Fix> fixes;
  for (const pose::Gnss& gnss : messages_of<pose::Gnss>(simulator)) {
    double x_m = 0.0, y_m = 0.0, z_m = 0.0;
    enu.Forward(gnss.latitude_deg, gnss.longitude_deg, gnss.altitude_m, x_m, y_m, z_m);
    fixes.push_back({seconds(gnss.utime), x_m, y_m, gnss});
  }
  return fixes;
}

TEST(BlockSensors, AntennaIsWhereItIsMounted) {
  RigConfig rig = block();
  rig.simulation.motion.gnss_sd_m = 0.0;
  rig.simulation.gnss.antenna_m = {-0.4, 0.25};
  Simulator simulator(SceneKind::kOrchard, 1, rig);
  const DrivePath path = simulator.scene().path;
  for (const Fix& fix : fixes_of(simulator, rig)) {
    const Pose2 base = path.pose_at(fix.time_s);
    const double forward_m = std::cos(base.yaw_rad) * (fix.x_m - base.x_m) +
                             std::sin(base.yaw_rad) * (fix.y_m - base.y_m);
    const double left_m = -std::sin(base.yaw_rad) * (fix.x_m - base.x_m) +
                          std::cos(base.yaw_rad) * (fix.y_m - base.y_m);
    EXPECT_NEAR(forward_m, -0.4, 1e-4);
    EXPECT_NEAR(left_m, 0.25, 1e-4);
  }
}

TEST(BlockSensors, FixesJumpFreezeStopAndClaimTooMuch) {
  RigConfig rig = block();
  ReceiverConfig& gnss = rig.simulation.gnss;
  rig.simulation.motion.gnss_sd_m = 0.02;
  gnss.jump_m = 30.0;
  gnss.jump = {10.0, 5.0, 40.0};
  gnss.freeze = {20.0, 4.0, 0.0};
  gnss.outage = {30.0, 6.0, 0.0};
  gnss.stated_sd_m = 0.001;
  Simulator simulator(SceneKind::kOrchard, 3, rig);
  const DrivePath path = simulator.scene().path;
  std::map<int, int> num_jumped;
  std::vector<Fix> frozen;
  std::int32_t seq = 0;
  double sum_m2 = 0.0;
  int num_sound = 0;
  for (const Fix& fix : fixes_of(simulator, rig)) {
    EXPECT_EQ(fix.gnss.seq, seq++);  // a silent receiver loses nothing
    EXPECT_FALSE(fix.time_s >= 30.0 && fix.time_s < 36.0 - 1e-6);
    EXPECT_NEAR(fix.gnss.covariance[0], 1e-6, 1e-12);
    EXPECT_EQ(fix.gnss.fix_quality, 4);
    const Pose2 base = path.pose_at(fix.time_s);
    const double off_m = std::hypot(fix.x_m - base.x_m, fix.y_m - base.y_m);
    if (fix.time_s > 20.0 - 1e-6 && fix.time_s < 24.0 - 1e-6) {
      frozen.push_back(fix);
    } else if (std::fmod(fix.time_s + 30.0 + 1e-6, 40.0) < 5.0 && fix.time_s > 9.9) {
      EXPECT_NEAR(off_m, 30.0, 0.2);
      ++num_jumped[static_cast<int>(fix.time_s + 30.0) / 40];
    } else {
      EXPECT_LT(off_m, 0.12);
      sum_m2 += off_m * off_m;
      ++num_sound;
    }
  }
  EXPECT_NEAR(std::sqrt(0.5 * sum_m2 / num_sound), 0.02, 0.003);  // true noise, not the claimed
  EXPECT_GE(num_jumped.size(), 2u);
  for (const auto& [number, count] : num_jumped) EXPECT_LE(count, 26);
  ASSERT_EQ(frozen.size(), 20u);
  for (const Fix& fix : frozen) {
    EXPECT_EQ(fix.gnss.latitude_deg, frozen[0].gnss.latitude_deg);
    EXPECT_EQ(fix.gnss.longitude_deg, frozen[0].gnss.longitude_deg);
  }
}

TEST(BlockSensors, OdometryStopsAndGoesOn) {
  RigConfig rig = block();
  rig.simulation.wheels.outage = {12.0, 10.0, 0.0};
  Simulator simulator(SceneKind::kOrchard, 4, rig);
  const auto odometry = messages_of<pose::Odometry>(simulator);
  double longest_s = 0.0, at_s = 0.0;
  for (std::size_t i = 1; i < odometry.size(); ++i) {
    EXPECT_EQ(odometry[i].seq, odometry[i - 1].seq + 1);
    const double gap_s = seconds(odometry[i].utime) - seconds(odometry[i - 1].utime);
    if (gap_s > longest_s) at_s = seconds(odometry[i - 1].utime);
    longest_s = std::max(longest_s, gap_s);
  }
  EXPECT_NEAR(longest_s, 10.0, 0.03);
  EXPECT_NEAR(at_s, 12.0, 0.03);
}

TEST(BlockSensors, WheelsGetTurnsWrongAsConfigured) {
  // over many runs the heading gained in one half circle has the configured scale error
  const auto turn_error = [](const WheelsConfig& wheels, std::uint64_t seed) {
    RigConfig rig = block();
    rig.simulation.wheels = wheels;
    rig.simulation.motion.yaw_rate_bias_sd_radps = 0.0;
    rig.simulation.motion.yaw_rate_sd_radps = 0.0;
    rig.simulation.motion.speed_scale_sd = 0.0;
    rig.simulation.motion.gnss_rate_hz = 0.0;
    rig.simulation.scanner.rate_hz = 0.1;
    Simulator simulator(SceneKind::kOrchard, seed, rig);
    double turned_rad = 0.0;
    while (const auto message = simulator.next()) {
      const auto* odometry = std::get_if<pose::Odometry>(&*message);
      if (odometry == nullptr) continue;
      if (seconds(odometry->utime) > 35.0) break;  // in the second aisle
      turned_rad += 0.02 * odometry->yaw_rate_radps;
      if (odometry->yaw_rate_radps == 0.0) {
        EXPECT_NEAR(odometry->covariance[2], 0.0, 1e-12);
      }
    }
    return turned_rad / -geometry::kPi - 1.0;
  };
  WheelsConfig scale;
  scale.yaw_rate_scale_sd = 0.03;
  double scale_sum = 0.0;
  constexpr int kRuns = 40;
  for (int seed = 1; seed <= kRuns; ++seed) scale_sum += std::pow(turn_error(scale, seed), 2);
  EXPECT_NEAR(std::sqrt(scale_sum / kRuns), 0.03, 0.011);
  EXPECT_NEAR(turn_error({}, 1), 0.0, 1e-3);
}

TEST(BlockSensors, CarriedRobotSeesNothingAndItsWheelsStandStill) {
  RigConfig rig = block();
  rig.simulation.scanner.rate_hz = 5.0;
  rig.simulation.carry = {15.0, 6.0, 3, true};
  Simulator simulator(SceneKind::kOrchard, 5, rig);
  EXPECT_TRUE(true_observations(simulator, rig, 17 * 5).empty());
  EXPECT_FALSE(true_observations(simulator, rig, 14 * 5).empty());
  int num_still = 0;
  while (const auto message = simulator.next()) {
    if (const auto* scan = std::get_if<laser::Scan>(&*message)) {
      const double t_s = seconds(scan->utime);
      const auto num_returns = std::count_if(scan->ranges_m.begin(), scan->ranges_m.end(),
                                             [](float range_m) { return range_m > 0.0f; });
      if (t_s > 15.0 && t_s < 20.9) {
        EXPECT_EQ(num_returns, 0);
      }
      if ((t_s > 5.0 && t_s < 14.0) || (t_s > 21.2 && t_s < 24.0)) {
        EXPECT_GT(num_returns, 10);
      }
    } else if (const auto* odometry = std::get_if<pose::Odometry>(&*message)) {
      const double t_s = seconds(odometry->utime);
      if (t_s < 15.05 || t_s > 20.99) continue;
      EXPECT_NEAR(odometry->speed_mps, 0.0, 0.06);
      ++num_still;
    }
  }
  EXPECT_NEAR(num_still, 297, 3);

  rig.simulation.carry.odometry = false;
  Simulator silent(SceneKind::kOrchard, 5, rig);
  for (const pose::Odometry& odometry : messages_of<pose::Odometry>(silent)) {
    const double t_s = seconds(odometry.utime);
    EXPECT_FALSE(t_s > 15.05 && t_s < 20.95);
  }
}

TEST(BlockSensors, InertialUnitTurnsWithTheRobotAndWanders) {
  RigConfig rig = block();
  ImuConfig& config = rig.simulation.imu;
  config.rate_hz = 50.0;
  config.angular_rate_sd_radps = 0.0;
  config.yaw_rate_bias_sd_radps = 0.0;
  config.yaw_rate_walk = 0.0;
  config.acceleration_sd_mps2 = 0.0;
  config.acceleration_bias_sd_mps2 = 0.0;
  config.orientation = true;
  config.orientation_sd_rad = 0.0;
  config.yaw_bias_sd_rad = 0.0;
  rig.simulation.orchard.speed_mps = 1.5;
  Simulator ideal(SceneKind::kOrchard, 6, rig);
  const DrivePath path = ideal.scene().path;
  double yaw_rad = path.pose_at(0.0).yaw_rad;
  int num_turning = 0;
  for (const pose::Imu& imu : messages_of<pose::Imu>(ideal)) {
    yaw_rad += 0.02 * imu.angular_rate_radps[2];
    EXPECT_TRUE(imu.has_orientation);
    EXPECT_NEAR(geometry::wrap_angle_rad(imu.yaw_rad - path.pose_at(seconds(imu.utime)).yaw_rad),
                0.0, 1e-9);
    EXPECT_NEAR(geometry::wrap_angle_rad(yaw_rad - imu.yaw_rad), 0.0, 0.03);
    EXPECT_NEAR(imu.acceleration_mps2[2], 9.807, 0.001);
    if (imu.angular_rate_radps[2] == 0.0) {
      EXPECT_EQ(imu.acceleration_mps2[1], 0.0);
    } else {
      // half circles of 2 m at 1.5 m/s
      EXPECT_NEAR(std::abs(imu.angular_rate_radps[2]), 0.75, 1e-9);
      EXPECT_NEAR(imu.acceleration_mps2[1], 1.5 * imu.angular_rate_radps[2], 1e-9);
      ++num_turning;
    }
  }
  EXPECT_GT(num_turning, 100);

  // a walk of 1e-4 rad/s in a second is 1e-3 rad/s after a hundred
  ImuConfig wandering;
  wandering.rate_hz = 50.0;
  wandering.yaw_rate_walk = 1e-4;
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const InertialUnit unit(seed, wandering, 120.0);
    sum += std::pow(unit.yaw_rate_bias_radps(110.5) - unit.yaw_rate_bias_radps(10.5), 2);
  }
  EXPECT_NEAR(std::sqrt(sum / 200.0), 1e-3, 2e-4);
}

constexpr double kDay_s = 86400.0;

TEST(ReceiverSky, GapsLastAsLongAsConfigured) {
  SkyConfig config;
  config.gap_every_s = 40.0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const ReceiverSky sky(seed, config);
    int num_gaps = 0, num_long = 0;
    double since_s = -1.0;
    for (double t = 0.0; t < kDay_s; t += 0.5) {
      if (!sky.is_open(t)) {
        if (since_s < 0.0) since_s = t;
      } else if (since_s >= 0.0) {
        ++num_gaps;
        EXPECT_GE(t - since_s, 19.0);
        num_long += t - since_s > 181.0 ? 1 : 0;
        since_s = -1.0;
      }
    }
    EXPECT_LT(num_long, 0.03 * num_gaps);  // two with less than a step between them
    // 40 s with fixes and 72.8 s (160 / ln 9) without, in turn
    EXPECT_NEAR(num_gaps, kDay_s / 112.8, 100.0);
  }
}

TEST(ReceiverSky, BurstsAndPausesFractionTheTime) {
  SkyConfig config;
  config.burst_s = 6.0;
  config.pause_s = 3.0;
  const ReceiverSky sky(7, config);
  int open = 0;
  for (int i = 0; i < 86400; ++i) open += sky.is_open(i) ? 1 : 0;
  EXPECT_NEAR(open / kDay_s, 6.0 / 9.0, 0.02);
}

TEST(ReceiverSky, WanderingErrorForgetsItselfInItsTime) {
  SkyConfig config;
  config.wander_sd_m = 2.5;
  config.wander_time_s = 60.0;
  const ReceiverSky sky(3, config);
  Eigen::Array3d variance = Eigen::Array3d::Zero(), later = Eigen::Array3d::Zero();
  int n = 0;
  for (double t = 0.0; t + 60.0 < kDay_s; t += 7.0) {
    const Eigen::Array3d now = sky.error_m(t);
    variance += now.square();
    later += now * sky.error_m(t + 60.0).array();
    ++n;
  }
  EXPECT_NEAR(std::sqrt(variance.head<2>().mean() / n), 2.5, 0.2);
  EXPECT_NEAR(std::sqrt(variance.z() / n), 5.0, 0.4);
  EXPECT_NEAR((later / variance).head<2>().mean(), std::exp(-1.0), 0.08);
  EXPECT_NEAR((later / variance).z(), std::exp(-1.0), 0.12);
}

TEST(ReceiverSky, ReflectionsTakeTheirFractionAndHoldTheirError) {
  SkyConfig config;
  config.multipath_fraction = 0.05;
  const ReceiverSky sky(9, config);
  int reflected = 0, held = 0, pairs = 0;
  for (double t = 0.0; t + 0.5 < kDay_s; t += 0.5) {
    if (!sky.is_reflected(t)) {
      ASSERT_EQ(sky.error_m(t).norm(), 0.0);
      continue;
    }
    ++reflected;
    if (!sky.is_reflected(t + 0.5)) continue;
    ++pairs;
    held += sky.error_m(t) == sky.error_m(t + 0.5) ? 1 : 0;
  }
  EXPECT_NEAR(reflected * 0.5 / kDay_s, 0.05, 0.01);
  EXPECT_GT(held, 0.98 * pairs);
}

constexpr OdometryErrors kRun{0.01, 0.002, -0.03};

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
