// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <map>
#include <vector>

#include "pose/scan_matching/surface_points.hpp"

namespace orchard::pose {

/// The scans that keyframes were made at, thinned and packed: sixteen bytes a point.
class KeptScans {
 public:
  /// Keeps the returns [m, base] of the scan taken at a keyframe; the newest last.
  void keep(int keyframe, const std::vector<SurfacePoint>& points);

  /// Whether a keyframe has a scan.
  bool has(int keyframe) const { return scans_.count(keyframe) != 0; }

  /// The returns of a keyframe's scan, moved by T_frame_base; none if it has no scan.
  std::vector<SurfacePoint> points(int keyframe, const Eigen::Vector3d& T_frame_base) const;

  /// Keyframes that have a scan, ascending, from `first` to before `end`.
  std::vector<int> between(int first, int end) const;

 private:
  struct Packed {
    float x_m, y_m, normal_x, normal_y;  ///< normal 0: not flat
  };
  std::map<int, std::vector<Packed>> scans_;
};

}  // namespace orchard::pose
