// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/simulator.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "geometry/angles.hpp"
#include "unit/simulation/rig.hpp"

namespace orchard::simulation {
namespace {

std::int64_t utime_of(const SensorMessage& message) {
  return std::visit([](const auto& m) { return m.utime; }, message);
}

std::vector<SensorMessage> run(Simulator simulator) {
  std::vector<SensorMessage> messages;
  while (auto message = simulator.next()) messages.push_back(std::move(*message));
  return messages;
}

RigConfig small_orchard() {
  RigConfig rig = test_rig();
  rig.simulation.orchard.trees_per_row = 5;
  rig.simulation.image.rate_hz = 1.0;
  rig.simulation.scanner.range_max_m = 20.0;  // so that no scan is empty
  return rig;
}

/// Equal to the last bit in everything that sensors measure.
bool same(const SensorMessage& a, const SensorMessage& b) {
  if (a.index() != b.index() || utime_of(a) != utime_of(b)) return false;
  if (const auto* scan = std::get_if<laser::Scan>(&a)) {
    return scan->ranges_m == std::get<laser::Scan>(b).ranges_m;
  }
  if (const auto* image = std::get_if<vision::Image>(&a)) {
    return image->data == std::get<vision::Image>(b).data;
  }
  if (const auto* odometry = std::get_if<pose::Odometry>(&a)) {
    const auto& other = std::get<pose::Odometry>(b);
    return odometry->speed_mps == other.speed_mps &&
           odometry->yaw_rate_radps == other.yaw_rate_radps;
  }
  if (const auto* gnss = std::get_if<pose::Gnss>(&a)) {
    return gnss->latitude_deg == std::get<pose::Gnss>(b).latitude_deg;
  }
  const auto& fix = std::get<pose::PoseFix>(a);
  const auto& other = std::get<pose::PoseFix>(b);
  return fix.x_m == other.x_m && fix.y_m == other.y_m && fix.yaw_rad == other.yaw_rad;
}

TEST(Simulator, MessagesComeInOrderWithRisingSeq) {
  for (const SceneKind kind : {SceneKind::kTubes, SceneKind::kOrchard}) {
    const auto messages = run(Simulator(kind, 2, small_orchard()));
    ASSERT_FALSE(messages.empty());
    std::array<std::int32_t, 5> seqs{};
    for (std::size_t i = 0; i < messages.size(); ++i) {
      const std::int32_t seq = std::visit([](const auto& m) { return m.seq; }, messages[i]);
      EXPECT_EQ(seq, seqs[messages[i].index()]++);
      if (i == 0) continue;
      const auto before = std::make_pair(utime_of(messages[i - 1]), messages[i - 1].index());
      EXPECT_LT(before, std::make_pair(utime_of(messages[i]), messages[i].index()));
    }
  }
}

TEST(Simulator, TubesGiveOnePairAndOneFixPerStep) {
  const RigConfig rig = test_rig();
  Simulator simulator(SceneKind::kTubes, 1, rig);
  const auto poses = simulator.true_poses();
  const auto messages = run(simulator);
  ASSERT_EQ(messages.size(), 3 * poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto& scan = std::get<laser::Scan>(messages[3 * i]);
    const auto& image = std::get<vision::Image>(messages[3 * i + 1]);
    const auto& fix = std::get<pose::PoseFix>(messages[3 * i + 2]);
    EXPECT_EQ(scan.utime, poses[i].utime);
    EXPECT_EQ(image.utime, poses[i].utime);
    EXPECT_EQ(fix.utime, poses[i].utime);
    EXPECT_NEAR(fix.x_m, poses[i].x_m, 0.005);
    EXPECT_NEAR(fix.y_m, poses[i].y_m, 0.005);
  }
}

TEST(Simulator, OneSeedGivesOneSetOfBytes) {
  for (const SceneKind kind : {SceneKind::kTubes, SceneKind::kOrchard}) {
    const auto first = run(Simulator(kind, 5, small_orchard()));
    const auto second = run(Simulator(kind, 5, small_orchard()));
    const auto other = run(Simulator(kind, 6, small_orchard()));
    ASSERT_EQ(first.size(), second.size());
    ASSERT_EQ(first.size(), other.size());
    std::size_t num_different = 0;
    for (std::size_t i = 0; i < first.size(); ++i) {
      EXPECT_TRUE(same(first[i], second[i])) << i;
      if (!same(first[i], other[i])) ++num_different;
    }
    EXPECT_EQ(num_different, first.size());
  }
}

TEST(Simulator, ASensorThatIsOffChangesNoOther) {
  RigConfig rig = small_orchard();
  const auto all = run(Simulator(SceneKind::kOrchard, 5, rig));
  rig.camera.enabled = false;
  rig.simulation.orchard.fix_rate_hz = 0.0;
  const auto fewer = run(Simulator(SceneKind::kOrchard, 5, rig));
  std::size_t k = 0;
  for (const SensorMessage& message : all) {
    if (std::holds_alternative<vision::Image>(message) ||
        std::holds_alternative<pose::PoseFix>(message)) {
      continue;
    }
    ASSERT_LT(k, fewer.size());
    EXPECT_TRUE(same(message, fewer[k++]));
  }
  EXPECT_EQ(k, fewer.size());
}

// Dead reckoning with what the wheels say ends where the robot is, within what their covariance
// and the run's errors allow; with perfect wheels it ends there exactly.
TEST(Simulator, OdometryIntegratesToThePath) {
  for (const bool perfect : {true, false}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      RigConfig rig = small_orchard();
      rig.camera.enabled = false;
      MotionConfig& motion = rig.simulation.motion;
      if (perfect) {
        motion.speed_scale_sd = motion.speed_sd_mps = 0.0;
        motion.yaw_rate_bias_sd_radps = motion.yaw_rate_sd_radps = 0.0;
      }
      Simulator simulator(SceneKind::kOrchard, seed, rig);
      const double length_m = simulator.scene().path.length_m();
      const double duration_s = simulator.scene().path.duration_s();
      Pose2 pose = simulator.scene().path.pose_at(0.0);
      Pose2 truth = pose;
      std::int64_t last_utime = kEpochUtime;
      double turned_rad = 0.0, odometer_m = 0.0, true_m = 0.0;
      while (const auto message = simulator.next()) {
        const auto* odometry = std::get_if<pose::Odometry>(&*message);
        if (odometry == nullptr) continue;
        const double dt_s = static_cast<double>(odometry->utime - last_utime) * 1e-6;
        last_utime = odometry->utime;
        const double turn_rad = odometry->yaw_rate_radps * dt_s;
        pose = compose(pose, {odometry->speed_mps * dt_s * std::cos(turn_rad / 2.0),
                              odometry->speed_mps * dt_s * std::sin(turn_rad / 2.0), turn_rad});
        turned_rad += turn_rad;
        odometer_m += odometry->speed_mps * dt_s;
        truth =
            simulator.scene().path.pose_at(static_cast<double>(last_utime - kEpochUtime) * 1e-6);
        true_m += dt_s * rig.simulation.orchard.speed_mps;
      }
      const double period_s = 1.0 / motion.odometry_rate_hz;
      const double yaw_sd_rad =
          std::hypot(motion.yaw_rate_bias_sd_radps * duration_s,
                     motion.yaw_rate_sd_radps * std::sqrt(period_s * duration_s));
      const double odometer_sd_m = std::hypot(
          motion.speed_scale_sd * length_m, motion.speed_sd_mps * std::sqrt(period_s * duration_s));
      EXPECT_LE(std::abs(geometry::wrap_angle_rad(pose.yaw_rad - truth.yaw_rad)),
                3.5 * yaw_sd_rad + 1e-6);
      EXPECT_LE(std::abs(odometer_m - true_m), 3.5 * odometer_sd_m + 1e-3);
      EXPECT_LE(std::hypot(pose.x_m - truth.x_m, pose.y_m - truth.y_m),
                3.5 * (odometer_sd_m + yaw_sd_rad * length_m) + 0.01);
    }
  }
}

}  // namespace
}  // namespace orchard::simulation
