// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "geometry/point_grid.hpp"
#include "pose/graph/graph.hpp"
#include "pose/graph/solver.hpp"
#include "pose/slam/coverage.hpp"
#include "pose/slam/scan_points.hpp"
#include "pose/slam_config.hpp"

namespace orchard::pose {

/// Why the whole graph is solved.
enum class SolveReason { kGrowth, kLoopClosure, kEndOfDrive, kTwinsAtEnd };

/// Graph, landmarks around the robot and odometry calibration: everything that a solve of the whole
/// graph, and so a loop closure, may change. A value: a closure that the observations refute is
/// undone by assigning the copy from before it, so that no member can be forgotten.
class SlamMap {
 public:
  /// `memory` holds old observations; none: the heap. It changes no result.
  explicit SlamMap(const SlamConfig& config, std::shared_ptr<ChunkMemory> memory = nullptr);

  bool empty() const { return graph.keyframes.empty(); }
  int newest() const { return static_cast<int>(graph.keyframes.size()) - 1; }
  const OdometryCalibration& newest_calibration() const { return graph.calibrations.back(); }

  /// Standard deviation of the newest keyframe against the landmarks around it [m], the larger
  /// axis.
  double local_sd_m() const;

  /// Whether positions place the present session, too.
  bool is_tied_down() const;

  /// How far landmarks are in sight [m]: by what was seen.
  double sight_m() const;

  /// What is known of the odometry calibration in an interval of travel after the last solve.
  CalibrationPrior calibration_at(int interval) const;

  /// Starts a disconnected submap at the newest keyframe, until a loop closure joins it.
  /// `was_lost`: known landmarks should have been in view; else there was nothing to go by.
  void start_session(bool was_lost);

  /// Finds anew which landmarks the next scan may show.
  void refresh_local();

  /// Adds a landmark that the newest keyframe observes first; returns its index.
  int add_landmark(const ScanPoint& point);

  /// Lets observations lie where old ones do that nothing is likely to change any more.
  void keep_old();

  /// Solves the whole graph, merges duplicates, and updates all that follows from it. False, and
  /// nothing changed but num_solved, if the solver found no solution.
  bool solve(SolveReason reason);

  /// After a position was added to the newest keyframe: moves the map to where positions put it,
  /// once they tell its place and direction; from then on solves the whole graph where the last one
  /// says more than is known, as after a gap.
  void take_position();

  SlamGraph graph;
  geometry::PointGrid index{4.0};  ///< of landmarks
  SensorCoverage coverage;
  CalibrationPrior calibration;  ///< of the odometry, by all observations up to the last solve
  int num_calibrated = 1;        ///< intervals of travel that it knows of
  std::vector<int> local;        ///< landmarks that the next scan may show
  int session_start = 0;         ///< first keyframe of the present session
  bool lost = false;             ///< it began where known landmarks should have been in view
  int num_solved = 0;            ///< keyframes at the last whole solve
  bool corrected = false;        ///< the past was corrected since it was last published

 private:
  void georeference();
  bool tells_more(const AbsolutePosition& position) const;
  void merge_duplicates();
  void rebuild_index();

  SlamConfig config_;
  int num_kept_ = 0;  ///< keyframes whose observations keep_old() has seen to
};

}  // namespace orchard::pose
