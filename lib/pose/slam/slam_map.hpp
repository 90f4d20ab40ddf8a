// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "geometry/point_grid.hpp"
#include "pose/field_of_view.hpp"
#include "pose/graph/graph.hpp"
#include "pose/graph/solver.hpp"
#include "pose/pose_config.hpp"
#include "pose/slam/association.hpp"
#include "pose/tuning.hpp"

namespace orchard::pose {

/// Travel within which an observed landmark stays in the local map, in sight ranges; derived: a
/// landmark is in view over twice the range while the robot passes it.
inline constexpr double kRecentTravel_ranges = 2.0;

/// Returns the standard deviation of a pose's position along the axis where it is larger [m].
double position_sd_m(const Eigen::Matrix3d& covariance);

/// Returns the landmarks, ascending, whose position relative to the robot is certain enough for the
/// association of single observations: those observed within the last kRecentTravel_ranges of
/// travel of the session, and those covisible with tracked ones on any pass. Other nearby landmarks
/// may be displaced by drift and are left to loop closure. `session_start` is the first keyframe of
/// the session, `range_m` the sight range, `radius_m` the search radius about the robot; being
/// tracked after the keyframe `joined_from` tells nothing of what was seen only before it.
std::vector<int> local_map(const SlamGraph& graph, const geometry::PointGrid& index,
                           int session_start, int joined_from, double range_m, double radius_m);

/// What a loop closer has done: searches among older landmarks or scans, accepted closures, those
/// undone after the solve, and a measure of cost without a clock.
struct LoopCounts {
  int num_searches = 0;
  int num_closures = 0;
  int num_refuted = 0;
  std::int64_t num_operations = 0;
};

/// Reason for a solve of the whole graph.
enum class SolveReason { kGrowth, kLoopClosure, kEndOfDrive, kDuplicatesAtEnd };

/// The state of SLAM that a solve of the whole graph may change: graph, local map and odometry
/// calibration. A wrong loop closure is undone by SlamUndo.
class SlamMap {
 public:
  /// `memory` stores old observations (null: the heap) and does not affect the results.
  explicit SlamMap(const SlamConfig& config, std::shared_ptr<ChunkAllocator> memory = nullptr);

  bool empty() const { return graph.keyframes.empty(); }
  int newest() const { return static_cast<int>(graph.keyframes.size()) - 1; }
  const OdometryCalibration& newest_calibration() const { return graph.calibrations.back(); }

  /// Returns the standard deviation of the newest keyframe relative to the landmarks around it [m],
  /// along the larger axis.
  double local_sd_m() const;

  /// True if the graph is georeferenced and the present session has absolute positions.
  bool is_session_georeferenced() const;

  /// Returns the sight range [m]: the range of the farthest observation, limited by the config.
  double detection_range_m() const;

  /// Returns the prior of the odometry calibration in an interval of travel after the last solve.
  CalibrationPrior calibration_at(int interval) const;

  /// Starts a new session at the newest keyframe: a disconnected submap until a loop closure joins
  /// it. `was_lost`: known landmarks should have been in view; else none were around.
  void start_session(bool was_lost);

  /// Updates `local` for the pose of the newest keyframe.
  void refresh_local();

  /// Adds a landmark first observed by the newest keyframe; returns its index.
  int add_landmark(const ScanPoint& point);

  /// Moves observations that are unlikely to change any more to the graph's memory.
  void archive_old_observations();

  /// Solves the whole graph, merges landmarks that are one tree and updates all dependent members.
  /// Returns false, with nothing merged, if the solver failed (only num_solved is changed) or if
  /// `accept` refuses the solved graph (poses and positions are changed).
  bool solve(
      SolveReason reason,
      const std::function<bool(const SlamGraph&)>& accept = [](const SlamGraph&) { return true; });

  /// Call after adding an absolute position to the newest keyframe. Georeferences the map as soon
  /// as the positions determine its pose. From then on, solves the whole graph if the position is
  /// more certain than the pose or contradicts it, as after a gap.
  void process_absolute_position();

  /// Length of the submaps by which the last large graph was solved [m].
  double submap_length_m() const { return config_.submap_length_m; }

  SlamGraph graph;
  geometry::PointGrid index{4.0};  ///< spatial index of landmarks
  SensorCoverage coverage;
  CalibrationPrior calibration;  ///< odometry calibration by all observations up to the last solve
  int num_calibrated = 1;        ///< intervals of travel included in `calibration`
  std::vector<int> local;        ///< local map: landmarks that may be visible in the next scan
  int session_start = 0;         ///< first keyframe of the present session
  bool lost = false;             ///< a session began although known landmarks should be in view
  int num_solved = 0;            ///< keyframes at the last whole solve
  int num_merged = 0;            ///< landmarks that the last whole solve merged
  bool corrected = false;        ///< the past was corrected since it was last published

 private:
  void georeference();
  GraphSolution solve_by_submaps(bool is_closure);
  bool is_informative(const AbsolutePosition& position) const;
  int merge_same_trees();
  void rebuild_index();

  SlamConfig config_;   ///< submap_length_m grows with the work of the solves
  int severed_at_ = 0;  ///< first keyframe of the last session to which the motion was guessed
  int num_kept_ = 0;    ///< keyframes whose observations archive_old_observations() has moved
};

/// Undoes a wrong loop closure: merges and a solve of the whole graph. It stores what these change,
/// less than half of the map: most of a keyframe is its motion and observations, which they keep.
class SlamUndo {
 public:
  /// Begins to record the merges of `map`, which must outlive this object.
  explicit SlamUndo(SlamMap& map);
  ~SlamUndo();
  SlamUndo(const SlamUndo&) = delete;
  SlamUndo& operator=(const SlamUndo&) = delete;

  /// Restores the map as it was; call it at most once.
  void restore();

 private:
  struct Pose {
    Eigen::Vector3d T_map_base;
    Eigen::Matrix3d covariance, calibration_cross, calibration_covariance;
  };
  struct Place {
    Eigen::Vector2d p_map;
    Eigen::Matrix2d information;
  };

  /// Copies everything except keyframes and landmarks.
  static SlamMap light_copy(SlamMap& map);

  SlamMap& map_;
  SlamMap others_;  ///< everything except keyframes and landmarks
  std::vector<Pose> poses_;
  std::vector<Place> places_;
};

}  // namespace orchard::pose
