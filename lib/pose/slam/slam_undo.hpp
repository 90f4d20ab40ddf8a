// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pose/slam/slam_map.hpp"

namespace orchard::pose {

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
