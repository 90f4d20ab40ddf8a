// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "pose/filter/fix_hypotheses.hpp"
#include "pose/filter/fusion_filter.hpp"
#include "pose/graph/georeference.hpp"
#include "pose/graph/graph.hpp"
#include "pose/graph/told_path.hpp"
#include "pose/motion.hpp"
#include "pose/pose_config.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::pose {

/// One credible path.
struct CrediblePath {
  double probability = 1.0;
  std::vector<PoseEstimate> poses;
};

/// Returns the mean of credible paths over the same times, with the covariance of their mixture: of
/// all estimates it has the smallest expected squared error.
///
/// Paths: one or more, of equally many poses; probabilities need not sum to 1. Headings are
/// averaged about those of the first, the likeliest.
std::vector<PoseEstimate> mean_path(const std::vector<CrediblePath>& paths);

/// Returns the largest standard deviation of these paths' positions about their mean [m]; 0 unless
/// it exceeds what the likeliest, the first, says of its own position there.
double notable_spread_m(const std::vector<CrediblePath>& paths);

/// Present pose of base by all positions so far, and the latest receiver error.
struct SmoothedPose {
  Eigen::Vector3d T_map_base = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  Eigen::Vector2d receiver_error_m = Eigen::Vector2d::Zero();
};

/// Smooths the path driven so far with all positions before and after: the graph of mode slam
/// without trunks.
///
/// The caller's filter provides the initial pose of each keyframe. A solve then estimates the
/// wheels' errors across a gap from both its ends, and identifies outliers among the positions.
class PathSmoother {
 public:
  explicit PathSmoother(const PoseConfig& config);

  /// Adds the motion up to the odometry's time; T_map_base is the filter's pose at that time.
  void add(const Odometry& odometry, const Eigen::Vector3d& T_map_base);

  /// Adds a position of a point on base; sets its T_keyframe_then and utime.
  void add(std::int64_t utime, AbsolutePosition position, const Eigen::Vector3d& T_map_base);

  /// Adds the pose told at a time at or after the last measurement, T_map_base, before which
  /// take_correction() is to be asked.
  void tell(std::int64_t utime, const Eigen::Vector3d& T_map_base);

  /// Transforms the path so far to map, once the filter has found its pose there.
  void place(const Eigen::Vector3d& T_map_local);

  /// Solves when the path has grown by a tenth, and some metres after a gap. Returns the present
  /// pose after a solve; none within a gap, where dead reckoning is better, and none if the solved
  /// path contradicts the newest position. Displaced positions are left out.
  std::optional<SmoothedPose> observe(const std::vector<DisplacedTime>& displaced);

  /// Solves with all measurements, at the end of the drive, by each of these histories, the
  /// likeliest first: the path is the mean of those that wheels could have driven, or that of the
  /// likeliest.
  void finish(const std::vector<DisplacementHistory>& histories);

  /// Returns the path after a solve; it also has both sides of each jump of the poses told.
  std::optional<Trajectory> take_correction();

  /// Returns the process noise of the wheels' errors by the last solve; none before the first.
  std::optional<WheelErrorNoise> wheel_error_noise() const;

  /// Returns the fixes that contradict the path of the last solve.
  RejectedFixes left_out() const { return rejected_fixes(graph_); }

  /// Returns how far the paths by equally credible histories lie apart at the end: their standard
  /// deviation where it is largest [m]; 0 if they are as one.
  double open_sd_m() const { return open_sd_m_; }

  /// Returns true if no history gave a path at the end that the wheels could have driven and most
  /// positions bear out: it may be wrong by much more than it says.
  bool is_doubtful() const { return is_doubtful_; }

 private:
  void close_gap();
  bool is_plausible() const;
  void follow(const Eigen::Vector3d& T_map_base);
  void add_keyframe(const Eigen::Vector3d& T_map_base);
  bool solve(const std::vector<DisplacedTime>& displaced, bool is_last_resort = false);

  SlamConfig config_;
  DeadReckoning motion_;  ///< motion since the newest keyframe
  SlamGraph graph_;
  ToldPath told_;
  int num_solved_ = 0;
  double position_travel_m_ = 0.0;      ///< travel at the last position
  std::size_t position_keyframe_ = 0;   ///< its keyframe
  std::optional<double> due_travel_m_;  ///< travel at which the solve after a gap is due
  std::size_t before_gap_ = 0;          ///< the last keyframe before that gap
  std::int32_t revision_ = 0;
  bool corrected_ = false;
  bool is_doubtful_ = false;
  std::vector<PoseEstimate> mean_;  ///< of the paths of all histories, at the end
  double open_sd_m_ = 0.0;
};

}  // namespace orchard::pose
