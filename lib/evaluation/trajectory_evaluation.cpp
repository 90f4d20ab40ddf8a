// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/trajectory_evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "geometry/angles.hpp"

namespace orchard::evaluation {
namespace {

bool earlier(const pose::PoseEstimate& a, const pose::PoseEstimate& b) { return a.utime < b.utime; }

simulation::TruePose interpolate(const pose::PoseEstimate& before, const pose::PoseEstimate& after,
                                 std::int64_t utime) {
  const auto span_us = static_cast<double>(after.utime - before.utime);
  const double share = span_us > 0.0 ? static_cast<double>(utime - before.utime) / span_us : 0.0;
  simulation::TruePose pose;
  pose.utime = utime;
  pose.x_m = before.x_m + share * (after.x_m - before.x_m);
  pose.y_m = before.y_m + share * (after.y_m - before.y_m);
  pose.yaw_rad = before.yaw_rad + share * geometry::wrap_angle_rad(after.yaw_rad - before.yaw_rad);
  return pose;
}

}  // namespace

TrajectoryEvaluation evaluate_trajectory(const std::vector<pose::PoseEstimate>& estimates,
                                         const std::vector<simulation::TruePose>& truth) {
  if (!std::is_sorted(estimates.begin(), estimates.end(), earlier)) {
    throw std::invalid_argument("evaluate_trajectory: the estimates are not in order of utime");
  }
  TrajectoryEvaluation evaluation;
  double position_sum_m2 = 0.0;
  double yaw_sum_rad2 = 0.0;
  for (const simulation::TruePose& true_pose : truth) {
    if (estimates.empty() || true_pose.utime < estimates.front().utime ||
        true_pose.utime > estimates.back().utime) {
      ++evaluation.num_outside;
      continue;
    }
    pose::PoseEstimate key;
    key.utime = true_pose.utime;
    const auto after = std::lower_bound(estimates.begin(), estimates.end(), key, earlier);
    const auto before = after == estimates.begin() ? after : after - 1;
    const simulation::TruePose pose = interpolate(*before, *after, true_pose.utime);
    const double position_m = std::hypot(pose.x_m - true_pose.x_m, pose.y_m - true_pose.y_m);
    const double yaw_rad = std::abs(geometry::wrap_angle_rad(pose.yaw_rad - true_pose.yaw_rad));
    ++evaluation.num_compared;
    position_sum_m2 += position_m * position_m;
    yaw_sum_rad2 += yaw_rad * yaw_rad;
    evaluation.position_max_m = std::max(evaluation.position_max_m, position_m);
    evaluation.yaw_max_rad = std::max(evaluation.yaw_max_rad, yaw_rad);
  }
  if (evaluation.num_compared > 0) {
    evaluation.position_rms_m = std::sqrt(position_sum_m2 / evaluation.num_compared);
    evaluation.yaw_rms_rad = std::sqrt(yaw_sum_rad2 / evaluation.num_compared);
  }
  return evaluation;
}

}  // namespace orchard::evaluation
