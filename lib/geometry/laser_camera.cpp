// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/laser_camera.hpp"

#include <cmath>

namespace orchard::geometry {

Eigen::Matrix3d paper_rotation(const std::array<double, 3>& phi_rad) {
  const double sx = std::sin(phi_rad[0]), cx = std::cos(phi_rad[0]);
  const double sy = std::sin(phi_rad[1]), cy = std::cos(phi_rad[1]);
  const double sz = std::sin(phi_rad[2]), cz = std::cos(phi_rad[2]);
  Eigen::Matrix3d phi;
  // clang-format off
  phi <<  cy * cz, cx * sz + sx * cz * sy, sx * sz - cx * sy * cz,
         -cy * sz, cx * cz - sx * sy * sz, sx * cz + cx * sy * sz,
               sy,               -sx * cy,                cx * cy;
  // clang-format on
  return phi;
}

LaserToCamera::LaserToCamera(const LaserCameraExtrinsics& extrinsics)
    : R_camera_laser_(paper_rotation(extrinsics.phi_rad).transpose()),
      delta_m_(extrinsics.delta_m[0], extrinsics.delta_m[1], extrinsics.delta_m[2]) {}

}  // namespace orchard::geometry
