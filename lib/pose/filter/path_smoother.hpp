// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "pose/filter/fusion_filter.hpp"
#include "pose/graph/georeference.hpp"
#include "pose/graph/graph.hpp"
#include "pose/pose_config.hpp"
#include "pose/slam/dead_reckoning.hpp"
#include "pose/trajectory.hpp"

namespace orchard::pose {

/// Where base is by all positions before, and what the receiver was wrong by last.
struct SmoothedPose {
  Eigen::Vector3d T_map_base = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  Eigen::Vector2d receiver_error_m = Eigen::Vector2d::Zero();
};

/// The way driven so far by all positions before and after: the graph of mode slam without trunks.
///
/// The light filter beside it says where base is now, and so where a new keyframe begins; solving
/// then finds the wheels' errors in a gap from both its ends, and judges in hindsight which
/// positions do not belong.
class PathSmoother {
 public:
  explicit PathSmoother(const PoseConfig& config);

  /// Motion up to the odometry's time, with where the filter has base then.
  void add(const Odometry& odometry, const Eigen::Vector3d& T_map_base);

  /// A position of a point on base; its T_keyframe_then and utime are filled in here.
  void add(std::int64_t utime, AbsolutePosition position, const Eigen::Vector3d& T_map_base);

  /// The filter has found its place: moves what was driven before to map.
  void place(const Eigen::Vector3d& T_map_local);

  /// Solves when the way has grown by a tenth, and some metres after a gap; where base is then.
  std::optional<SmoothedPose> observe();

  /// Solves with all that there is.
  void finish();

  std::optional<Trajectory> take_correction();

  /// How much the wheels' errors change, as the last solve has it; none before the first.
  std::optional<WheelChanges> wheel_changes() const;

  /// By the last solve.
  FixesLeftOut left_out() const { return fixes_left_out(graph_); }

 private:
  void follow(const Eigen::Vector3d& T_map_base);
  void add_keyframe(const Eigen::Vector3d& T_map_base);
  bool solve();

  SlamConfig config_;
  DeadReckoning motion_;  ///< since the newest keyframe
  SlamGraph graph_;
  int num_solved_ = 0;
  double position_travel_m_ = 0.0;      ///< where the last position was
  std::optional<double> due_travel_m_;  ///< where the end of a gap is known well enough
  std::int32_t revision_ = 0;
  bool corrected_ = false;
};

}  // namespace orchard::pose
