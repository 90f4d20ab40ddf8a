// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "pose/pose_estimate.hpp"

namespace orchard::mapping {

/// Base to map for points at the height of base, worked out once for all of a scan.
///
/// Shalal et al. 2013, eqs. 11-12, generalised to all three angles; what leaves the plane is left
/// out.
class PoseComposition {
 public:
  explicit PoseComposition(const pose::PoseEstimate& T_map_base);

  /// Where a point [m] of base lies in map.
  Eigen::Vector2d apply(double x_base_m, double y_base_m) const {
    // Shalal et al. 2013, eq. 11 (x) and eq. 12 (y) of a robot that looks anywhere.
    return {xx_ * x_base_m + xy_ * y_base_m + x_m_, yx_ * x_base_m + yy_ * y_base_m + y_m_};
  }

 private:
  double xx_, xy_, x_m_;
  double yx_, yy_, y_m_;
};

}  // namespace orchard::mapping
