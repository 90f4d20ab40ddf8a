// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "pose/slam/motion.hpp"

namespace orchard::pose {

/// All that one keyframe saw of one landmark, summed up as information about its place in base at
/// the keyframe: the scans of a keyframe weigh as one sighting each, and take the room of one.
struct SlamSighting {
  int landmark = -1;
  int num_scans = 0;
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();    ///< sum of inverse covariances
  Eigen::Vector2d information_m = Eigen::Vector2d::Zero();  ///< sum of information * position
  double floor_sd_m = 0.0;  ///< of what does not average out within a keyframe

  Eigen::Vector2d position() const;
  Eigen::Matrix2d covariance() const;
};

/// An outside statement of a place: where a point fixed to base (a lever arm away) was in map.
struct PlaceFix {
  Eigen::Vector3d T_keyframe_then = Eigen::Vector3d::Zero();  ///< base when it was made
  Eigen::Vector2d lever_base_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d p_map = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
  bool has_yaw = false;
  double yaw_rad = 0.0;
  double yaw_sd_rad = 1.0;
};

/// A pose of the robot that the graph keeps.
struct Keyframe {
  std::int64_t utime = 0;
  Eigen::Vector3d T_map_base = Eigen::Vector3d::Zero();
  /// Of T_map_base in map: by the last whole solve, or composed since.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  /// Of T_map_base against the landmarks around it, as it was when the keyframe was the newest.
  Eigen::Matrix3d local_covariance = Eigen::Matrix3d::Zero();
  RelativeMotion motion;  ///< from the keyframe before
  double travel_m = 0.0;  ///< path length since the start
  int calibration = 0;    ///< index of the wheels' errors of the motion to it
  std::vector<SlamSighting> sightings;
  std::vector<PlaceFix> fixes;
};

/// What the robot may have seen more than once.
struct SlamLandmark {
  Eigen::Vector2d p_map = Eigen::Vector2d::Zero();
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();  ///< of its sightings, poses as given
  double width_m = 0.0;                                   ///< mean of its sightings
  double width_information = 0.0;                         ///< sum of inverse variances
  std::vector<int> keyframes;                             ///< that saw it, ascending
  int num_misses = 0;  ///< keyframes that should have seen it and did not
  bool alive = true;   ///< false: dropped, or merged into another
  bool confirmed = false;

  /// Of its place against the poses that saw it.
  Eigen::Matrix2d covariance() const;
};

/// Poses, landmarks and what ties them together. Indices are stable; nothing is ever renumbered.
struct SlamGraph {
  std::vector<Keyframe> keyframes;
  std::vector<SlamLandmark> landmarks;
  std::vector<WheelErrors> calibrations;
  bool placed = false;  ///< fixes say where map is; else the first keyframe is its origin

  /// Adds one scan's sighting to what a keyframe saw of a landmark.
  void add_sighting(int keyframe, int landmark, const Eigen::Vector2d& p_base,
                    const Eigen::Matrix2d& covariance, double floor_sd_m);

  /// Forgets what fewer than `num_scans` scans of the newest keyframe saw.
  void drop_rare_sightings(double num_scans);

  /// Forgets a landmark and all sightings of it.
  void drop(int landmark);

  /// Makes `landmark` the same as `into`: its sightings become sightings of that.
  void merge(int landmark, int into);

  /// Whether one keyframe saw both: then they are not the same.
  bool seen_together(int a, int b) const;

  /// Information about a landmark's place from all its sightings, the poses taken as they are; the
  /// place itself as well if asked.
  void replace(int landmark, bool place);
};

}  // namespace orchard::pose
