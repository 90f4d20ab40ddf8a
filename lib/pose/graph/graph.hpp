// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "pose/graph/motion.hpp"
#include "pose/graph/observation_list.hpp"

namespace orchard::pose {

/// Position in map of a point fixed to base (a lever arm away), and perhaps base's heading.
struct AbsolutePosition {
  std::int64_t utime = 0;
  Eigen::Vector3d T_keyframe_then = Eigen::Vector3d::Zero();  ///< base at the time of measurement
  Eigen::Vector2d lever_base_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d p_map = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
  bool has_yaw = false;
  double yaw_rad = 0.0;
  double yaw_sd_rad = 1.0;
  bool by_receiver = false;  ///< satellites gave it: the receiver's error of the time counts
  int receiver_error = -1;   ///< which of the graph's that is
};

/// What a satellite receiver is wrong by for a while, the same for all its fixes meanwhile.
struct ReceiverError {
  std::int64_t utime = 0;  ///< of the first of these fixes
  Eigen::Vector2d p_m = Eigen::Vector2d::Zero();
  double claimed_variance = 0.0;  ///< of those fixes, per axis [m2]
};

/// What of a receiver's claimed variance its fixes show.
struct ReceiverModel {
  double lasting = 0.0;  ///< fraction that is an error that lasts
  double noise = 1.0;    ///< the noise of each fix, as a multiple of what is claimed
};

/// A pose of the robot that the graph keeps.
struct Keyframe {
  std::int64_t utime = 0;
  Eigen::Vector3d T_map_base = Eigen::Vector3d::Zero();
  /// Of T_map_base in map [m, m, rad]: by the last whole solve, or composed since.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  /// With the odometry calibration of that time (rows T_map_base), and of the calibration: errors
  /// of wheels last, and what they add next is no news.
  Eigen::Matrix3d calibration_cross = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d calibration_covariance = Eigen::Matrix3d::Zero();
  /// Of T_map_base against the landmarks around it, when the keyframe was the newest.
  Eigen::Matrix3d local_covariance = Eigen::Matrix3d::Zero();
  RelativeMotion motion;  ///< from the keyframe before
  double travel_m = 0.0;  ///< path length since the start
  int calibration = 0;    ///< index of the odometry calibration of `motion`
  ObservationList observations;
  std::vector<AbsolutePosition> positions;
};

/// An object that may be observed more than once.
struct SlamLandmark {
  Eigen::Vector2d p_map = Eigen::Vector2d::Zero();
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();  ///< of p_map, given the poses
  double width_m = 0.0;                                   ///< mean of its observations
  double width_information = 0.0;                         ///< sum of inverse variances
  std::vector<int> keyframes;                             ///< that observed it, ascending
  double seen_m = 0.0;                                    ///< farthest that it was observed from
  int num_misses = 0;  ///< keyframes that should have observed it and did not
  bool alive = true;   ///< false: dropped, or merged into another
  bool confirmed = false;

  /// Of p_map against the poses that observed it.
  Eigen::Matrix2d covariance() const;

  /// Standard deviation of the mean width [m]; 1 m before the first observation.
  double width_sd_m() const;

  /// Adds one scan's width to the mean.
  void add_width(double observed_m, double sd_m);
};

/// Where one keyframe stands seen from another, by their scans.
struct RelativePose {
  int from = 0;
  int to = 0;  ///< the later one
  Eigen::Vector3d T_from_to = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< of T_from_to
};

/// Poses, landmarks and the measurements between them. Indices are stable: nothing is renumbered.
struct SlamGraph {
  std::vector<Keyframe> keyframes;
  std::vector<SlamLandmark> landmarks;
  std::vector<OdometryCalibration> calibrations;
  /// Of the calibration's change from one interval to the next, as far as the drive has told.
  Eigen::Vector3d calibration_walk_sd = Eigen::Vector3d::Zero();
  std::vector<ReceiverError> receiver_errors;
  ReceiverModel receiver;
  std::vector<RelativePose> relative_poses;   ///< ascending by `to`
  std::shared_ptr<ObservationMemory> memory;  ///< of old observations; none: the heap
  bool georeferenced = false;  ///< by absolute positions; else the first keyframe is the origin

  /// Adds one scan's observation of a landmark to those of a keyframe.
  void add_observation(int keyframe, int landmark, const Eigen::Vector2d& p_base,
                       const Eigen::Matrix2d& covariance, double floor_sd_m);

  /// Drops observations by fewer than `num_scans` scans of the newest keyframe: clutter.
  void drop_rare_observations(double num_scans);

  /// Drops a landmark and all observations of it.
  void drop(int landmark);

  /// Merges `landmark` into another: its observations become those of `into`.
  void merge(int landmark, int into);

  /// Whether one keyframe observed both: then they are two objects.
  bool co_observed(int a, int b) const;

  /// Recomputes a landmark's information from all its observations, given the poses; and its
  /// position as well if asked.
  void update_landmark(int landmark, bool update_position);

  /// The same of many landmarks in one pass over the keyframes, to the same digits.
  enum class Update : char { kNone, kInformation, kPosition };
  void update_landmarks(const std::vector<Update>& updates);

  /// Calls visit(index, keyframe) for all keyframes in order; what lies in a file is in memory only
  /// while it is read.
  template <class Visit>
  void for_each_keyframe(Visit&& visit) const {
    constexpr int kBetweenRests = 200;
    for (int k = 0; k < static_cast<int>(keyframes.size()); ++k) {
      if (memory && k % kBetweenRests == 0) memory->rest();
      visit(k, keyframes[static_cast<std::size_t>(k)]);
    }
    if (memory) memory->rest();
  }
};

}  // namespace orchard::pose
