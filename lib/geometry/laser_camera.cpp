// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/laser_camera.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::geometry {

Eigen::Matrix3d paper_rotation(const std::array<double, 3>& phi_rad) {
  const double sx = std::sin(phi_rad[0]), cx = std::cos(phi_rad[0]);
  const double sy = std::sin(phi_rad[1]), cy = std::cos(phi_rad[1]);
  const double sz = std::sin(phi_rad[2]), cz = std::cos(phi_rad[2]);
  Eigen::Matrix3d phi;  // Shalal et al. 2013, eq. 2
  // clang-format off
  phi <<  cy * cz, cx * sz + sx * cz * sy, sx * sz - cx * sy * cz,
         -cy * sz, cx * cz - sx * sy * sz, sx * cz + cx * sy * sz,
               sy,               -sx * cy,                cx * cy;
  // clang-format on
  return phi;
}

std::array<double, 3> paper_angles_rad(const Eigen::Matrix3d& R) {
  const double phi_y = std::asin(std::clamp(R(0, 2), -1.0, 1.0));
  if (std::hypot(R(1, 2), R(2, 2)) < 1e-9) return {std::atan2(R(2, 1), R(1, 1)), phi_y, 0.0};
  return {std::atan2(-R(1, 2), R(2, 2)), phi_y, std::atan2(-R(0, 1), R(0, 0))};
}

LaserToCamera::LaserToCamera(const LaserCameraExtrinsics& extrinsics)
    : R_camera_laser_(paper_rotation(extrinsics.phi_rad).transpose()),
      delta_m_(extrinsics.delta_m[0], extrinsics.delta_m[1], extrinsics.delta_m[2]) {}

}  // namespace orchard::geometry
