// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "pose/pose_estimate.hpp"

namespace orchard::mapping {

/// Transforms points at the height of base from base to map; the coefficients are computed once per
/// scan.
///
/// Shalal et al. 2013, eqs. 11-12, generalised to all three angles; the z component is dropped.
class PoseComposition {
 public:
  explicit PoseComposition(const pose::PoseEstimate& T_map_base);

  /// Position in map of a point in base [m].
  Eigen::Vector2d apply(double x_base_m, double y_base_m) const {
    // Shalal et al. 2013, eq. 11 (x) and eq. 12 (y), for any orientation of the robot.
    return {xx_ * x_base_m + xy_ * y_base_m + x_m_, yx_ * x_base_m + yy_ * y_base_m + y_m_};
  }

 private:
  double xx_, xy_, x_m_;
  double yx_, yy_, y_m_;
};

}  // namespace orchard::mapping
