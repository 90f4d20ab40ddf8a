// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/trajectory_evaluation.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "geometry/angles.hpp"

namespace orchard::evaluation {
namespace {

pose::PoseEstimate estimate(std::int64_t utime, double x_m, double yaw_rad) {
  pose::PoseEstimate pose;
  pose.utime = utime;
  pose.x_m = x_m;
  pose.yaw_rad = yaw_rad;
  return pose;
}

TEST(EvaluateTrajectory, InterpolatesBetweenEstimates) {
  const TrajectoryEvaluation evaluation =
      evaluate_trajectory({estimate(0, 0.0, 0.0), estimate(1000, 1.0, 0.2)},
                          {{500, 0.5, 0.3, 0.1}, {1000, 1.0, 0.4, 0.2}});
  EXPECT_EQ(evaluation.num_compared, 2);
  EXPECT_NEAR(evaluation.position_max_m, 0.4, 1e-12);
  EXPECT_NEAR(evaluation.position_rms_m, 0.35355339059327379, 1e-12);  // sqrt((0.09 + 0.16) / 2)
  EXPECT_NEAR(evaluation.yaw_max_rad, 0.0, 1e-12);
}

TEST(EvaluateTrajectory, YawGoesTheShorterWay) {
  const double almost_pi_rad = geometry::kPi - 0.1;
  const TrajectoryEvaluation evaluation =
      evaluate_trajectory({estimate(0, 0.0, almost_pi_rad), estimate(1000, 0.0, -almost_pi_rad)},
                          {{500, 0.0, 0.0, geometry::kPi}});
  EXPECT_NEAR(evaluation.yaw_max_rad, 0.0, 1e-12);
}

TEST(EvaluateTrajectory, ExtrapolatesNothing) {
  const TrajectoryEvaluation evaluation =
      evaluate_trajectory({estimate(100, 0.0, 0.0), estimate(200, 0.0, 0.0)},
                          {{99, 0, 0, 0}, {100, 0, 0, 0}, {201, 0, 0, 0}});
  EXPECT_EQ(evaluation.num_compared, 1);
  EXPECT_EQ(evaluation.num_outside, 2);
}

TEST(EvaluateTrajectory, RefusesDisorder) {
  EXPECT_THROW(evaluate_trajectory({estimate(2, 0, 0), estimate(1, 0, 0)}, {}),
               std::invalid_argument);
}

}  // namespace
}  // namespace orchard::evaluation
