// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/pose2.hpp"
#include "pose/pose_estimate.hpp"
#include "pose/trajectory.hpp"

namespace orchard::view {

/// Where the robot was, bounded however long it drives: a point every so often, and the poses of
/// the last moments.
class LivePath {
 public:
  /// Points that the path has at most; beyond, every second is left out and the step doubles.
  static constexpr std::size_t kPointsMax = 20000;

  void take(const pose::PoseEstimate& pose);

  /// A page of the corrected past: with its last the path is drawn anew.
  void take(const pose::TrajectoryPage& page);

  const std::optional<pose::PoseEstimate>& last() const { return last_; }

  /// Pose of base at a time between two of the last poses; none before or after.
  std::optional<geometry::Pose2> pose_at(std::int64_t utime) const;

  const std::vector<Eigen::Vector2d>& points() const { return points_; }

  /// +1 whenever points that were there have changed.
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
