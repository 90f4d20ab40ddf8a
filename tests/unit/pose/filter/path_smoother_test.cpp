// SPDX-License-Identifier: BSD-3-Clause
#include "pose/filter/path_smoother.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "geometry/angles.hpp"
#include "pose/motion.hpp"

namespace orchard::pose {
namespace {

// Truth: a wide circle at 2 m/s; wheels whose yaw rate is off by a constant, fixes of 2 cm but for
// a gap.

constexpr double kSpeed_mps = 2.0;
constexpr double kYawRate_radps = 0.02;

Eigen::Vector3d truth_at(double time_s) { return arc_motion(kSpeed_mps, kYawRate_radps, time_s); }

TEST(PathSmoother, AGapIsFilledFromBothItsEnds) {
  constexpr double kFrom_s = 100.0, kTo_s = 220.0, kEnd_s = 300.0;
  PathSmoother smoother{PoseConfig{}};
  smoother.place(Eigen::Vector3d::Zero());
  for (int i = 0; i <= static_cast<int>(kEnd_s * 20.0); ++i) {
    const double time_s = i / 20.0;
    const bool in_gap = time_s > kFrom_s && time_s < kTo_s;
    Eigen::Vector3d guess = truth_at(time_s);
    // What a filter without fixes makes of the wrong turn rate: far off at the gap's end.
    const double since_s = time_s - kFrom_s;
    if (in_gap) guess.y() += 0.5 * 0.008 * kSpeed_mps * since_s * since_s;
    Odometry odometry;
    odometry.utime = static_cast<std::int64_t>(1e6 * time_s);
    odometry.speed_mps = kSpeed_mps;
    odometry.yaw_rate_radps = kYawRate_radps + 0.008;
    smoother.add(odometry, guess);
    if (!in_gap && i % 4 == 0) {
      AbsolutePosition position;
      position.p_map = truth_at(time_s).head<2>();
      position.covariance = 1e-2 * Eigen::Matrix2d::Identity();
      position.is_gnss = true;
      smoother.add(odometry.utime, position, guess);
    }
    smoother.observe({});
  }
  ASSERT_TRUE(smoother.take_correction());  // at the gap's end at the latest
  smoother.finish({});
  const auto trajectory = smoother.take_correction();
  ASSERT_TRUE(trajectory);
  EXPECT_FALSE(smoother.take_correction());
  ASSERT_GT(trajectory->poses.size(), 100u);
  for (const PoseEstimate& pose : trajectory->poses) {
    const Eigen::Vector3d truth = truth_at(1e-6 * static_cast<double>(pose.utime));
    EXPECT_LT(std::hypot(pose.x_m - truth.x(), pose.y_m - truth.y()),
              0.01 * (kTo_s - kFrom_s) * kSpeed_mps);
    EXPECT_LT(std::abs(geometry::wrap_angle_rad(pose.yaw_rad - truth.z())), 0.05);
  }
  EXPECT_EQ(smoother.left_out().num_left_out, 0);
}

}  // namespace
}  // namespace orchard::pose
