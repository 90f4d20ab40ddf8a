// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/camera_model.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::geometry {
namespace {

double radial_factor(const std::array<double, 5>& kc, double r2) {
  return 1.0 + r2 * (kc[0] + r2 * (kc[1] + r2 * kc[4]));
}

double radial_slope(const std::array<double, 5>& kc, double r2) {
  return 1.0 + r2 * (3.0 * kc[0] + r2 * (5.0 * kc[1] + r2 * 7.0 * kc[4]));
}

/// The radius at which r * radial_factor(r^2) stops growing, or `limit`.
double monotonic_radius(const std::array<double, 5>& kc, double limit) {
  constexpr double kStep = 1e-3;  // derived: 0.06 degrees
  for (double r = kStep; r < limit; r += kStep) {
    if (radial_slope(kc, r * r) <= 0.0) return r - kStep;
  }
  return limit;
}

}  // namespace

CameraModel::CameraModel(const CameraIntrinsics& intrinsics) : intrinsics_(intrinsics) {
  // 80 degrees from the axis, beyond any lens that this model describes.
  max_radius_ = monotonic_radius(intrinsics_.kc, std::tan(80.0 * 3.14159265358979323846 / 180.0));
}

Eigen::Vector2d CameraModel::distort(const Eigen::Vector2d& n) const {
  const auto& kc = intrinsics_.kc;
  const double x = n.x(), y = n.y();
  const double r2 = x * x + y * y;
  // Shalal et al. 2013, eq. 5: tangential distortion; eq. 4 adds it to the radial one.
  const double radial = radial_factor(kc, r2);
  const double dx = 2.0 * kc[2] * x * y + kc[3] * (r2 + 2.0 * x * x);
  const double dy = kc[2] * (r2 + 2.0 * y * y) + 2.0 * kc[3] * x * y;
  return {radial * x + dx, radial * y + dy};  // eq. 4
}

std::optional<Eigen::Vector2d> CameraModel::project(const Eigen::Vector3d& p_camera) const {
  if (!(p_camera.z() > 0.0)) return std::nullopt;
  // Shalal et al. 2013, eq. 3
  const Eigen::Vector2d normalized(p_camera.x() / p_camera.z(), p_camera.y() / p_camera.z());
  if (!(normalized.norm() <= max_radius_)) return std::nullopt;
  const Eigen::Vector2d d = distort(normalized);
  // Shalal et al. 2013, eq. 6; eq. 7 is the same as a matrix.
  return Eigen::Vector2d(
      intrinsics_.fc_px[0] * (d.x() + intrinsics_.alpha_c * d.y()) + intrinsics_.cc_px[0],
      intrinsics_.fc_px[1] * d.y() + intrinsics_.cc_px[1]);
}

bool CameraModel::in_image(const Eigen::Vector2d& pixel) const {
  return pixel.x() >= -0.5 && pixel.y() >= -0.5 && pixel.x() < intrinsics_.width_px - 0.5 &&
         pixel.y() < intrinsics_.height_px - 0.5;
}

Eigen::Vector2d CameraModel::undistort(const Eigen::Vector2d& pixel) const {
  Eigen::Vector2d d;
  d.y() = (pixel.y() - intrinsics_.cc_px[1]) / intrinsics_.fc_px[1];
  d.x() = (pixel.x() - intrinsics_.cc_px[0]) / intrinsics_.fc_px[0] - intrinsics_.alpha_c * d.y();
  Eigen::Vector2d n = d;
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector2d error = distort(n) - d;
    n -= error;
    if (error.squaredNorm() < 1e-20) break;
  }
  return n;
}

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
