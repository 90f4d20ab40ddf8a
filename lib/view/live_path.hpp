// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/pose2.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::view {

/// Path of the robot with bounded memory: points at a step that grows with the length, and the
/// poses of the last seconds.
class LivePath {
 public:
  /// Max number of points; beyond it every second point is dropped and the step doubles.
  static constexpr std::size_t kPointsMax = 20000;

  void take(const pose::PoseEstimate& pose);

  /// Adds a page of the corrected trajectory; with the last page the path is replaced.
  void take(const pose::TrajectoryPage& page);

  const std::optional<pose::PoseEstimate>& last() const { return last_; }

  /// Interpolated pose of base among the last poses; none outside their times.
  std::optional<geometry::Pose2> pose_at(std::int64_t utime) const;

  const std::vector<Eigen::Vector2d>& points() const { return points_; }

  /// Incremented whenever existing points have changed.
  std::int64_t generation() const { return generation_; }

 private:
  void add_point(const Eigen::Vector2d& p);

  std::optional<pose::PoseEstimate> last_;
  std::vector<pose::PoseEstimate> recent_;
  std::vector<Eigen::Vector2d> points_;
  double step_m_ = 0.05;
  std::int64_t generation_ = 0;
  pose::TrajectoryCollector collector_;
};

}  // namespace orchard::view
