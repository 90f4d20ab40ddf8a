// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pose/measurements.hpp"
#include "pose/pose_estimate.hpp"
#include "pose/slam/association.hpp"
#include "pose/slam/coverage.hpp"
#include "pose/slam/dead_reckoning.hpp"
#include "pose/slam/loop_closure.hpp"
#include "pose/slam/slam_config.hpp"
#include "pose/slam/slam_map.hpp"
#include "pose/trajectory.hpp"

namespace orchard::pose {

/// T_map_base from relative motion and trunks whose identities nobody knows, with no map before:
/// keyframes and landmarks in a graph. Every scan is matched to the landmarks around the robot;
/// every keyframe corrects the last stretch of path; loop closures, growth and the end correct all
/// of it. Measurements come in order of time; a pure function of their sequence.
class TrunkSlam {
 public:
  explicit TrunkSlam(const SlamConfig& config);

  /// Used for odometry that states no covariance.
  void set_default_noise(double speed_sd_fraction, double yaw_rate_sd_radps);

  void add(const Odometry& odometry);
  /// The motion T_before_now from the last measured time to `utime`, where no wheels measure it.
  void add_motion(std::int64_t utime, const Eigen::Vector3d& T_before_now,
                  const Eigen::Matrix3d& covariance);
  void add(const SeenTrunks& seen);
  /// A statement of where base, or a point on it, is in map; T_keyframe_then is filled in here.
  /// Until fixes have told where the map lies and how it is turned, its origin is the first pose.
  void add_fix(std::int64_t utime, PlaceFix fix);

  /// The end of the drive: the last and best correction.
  void finish();

  std::optional<PoseEstimate> estimate() const;
  std::optional<Trajectory> take_correction();
  std::string warning() const;

  const SlamGraph& graph() const { return map_.graph; }
  /// Loop closures that stand, and those that the observations refuted once they were solved.
  int num_closures() const { return num_closures_; }
  int num_refuted_closures() const { return num_refuted_; }
  /// Work done so far, in pairs looked at and terms solved: what a scan costs, without a clock.
  std::int64_t num_operations() const { return num_operations_; }

 private:
  WheelErrors current_errors() const;
  Eigen::Matrix3d motion_covariance() const;
  bool wants_keyframe(double factor) const;
  void open_keyframe();
  void place_in_map();
  double local_sd_m() const;
  void begin_anew();
  void refresh_local_map();
  bool is_elsewhere();
  void match(const std::vector<ScanPoint>& points);
  void correct_window();
  void compose_covariance_in_map(int first, const Eigen::Matrix3d& drift);
  void review_landmarks();
  enum class WholeReason { kGrown, kClosing, kEnd };
  bool solve_all(WholeReason reason);
  void look_for_closure();
  std::optional<ClosureQuestion> closure_question() const;
  bool agrees(const std::vector<std::pair<int, int>>& merged) const;
  void merge_same();
  void rebuild_index();
  int begin_landmark(const ScanPoint& point);
  AssociationCandidate candidate(int landmark) const;

  SlamConfig config_;
  SlamMap map_;
  SlamSightField sight_;
  DeadReckoning motion_;
  int num_ambiguous_ = 0;         ///< scans in a row that could not be told from another place
  int num_contradicted_ = 0;      ///< scans since the last match that should have matched
  int num_matched_ = 0;           ///< of the last scan
  int num_scans_ = 0;             ///< of the newest keyframe
  int num_closed_ = 0;            ///< keyframes when a loop was last closed, or refused
  double looked_travel_m_ = 0.0;  ///< where a closure was last looked for
  bool closure_ambiguous_ = false;
  int num_closures_ = 0;
  int num_refuted_ = 0;
  std::int32_t revision_ = 0;
  std::int64_t num_operations_ = 0;
};

}  // namespace orchard::pose
