// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/extrinsics/extrinsics_check.hpp"

#include <fmt/core.h>
#include <Eigen/Geometry>
#include <cmath>

#include "geometry/angles.hpp"

namespace orchard::calibration {
namespace {

constexpr double kLargest_deg = 45.0;
constexpr double kOtherSide_m = 0.05;

double angle_deg(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return Eigen::AngleAxisd(a.transpose() * b).angle() * 180.0 / geometry::kPi;
}

/// The extrinsics that a calibration finds for a mirrored image: the two directions of the scan
/// plane are mirrored, and the third completes the rotation.
RigidExtrinsics mirrored(const RigidExtrinsics& mount, const Eigen::Vector3d& mirror) {
  RigidExtrinsics seen;
  seen.R_camera_laser = mirror.asDiagonal() * mount.R_camera_laser;
  seen.R_camera_laser.col(2) *= -1.0;
  seen.delta_m = mirror.asDiagonal() * mount.delta_m;
  return seen;
}

}  // namespace

std::string extrinsics_contradiction(const RigidExtrinsics& found, const RigidExtrinsics& stated) {
  const double turned_deg = angle_deg(found.R_camera_laser, stated.R_camera_laser);
  if (turned_deg > kLargest_deg) {
    const RigidExtrinsics left_right = mirrored(stated, {-1.0, 1.0, 1.0});
    if (angle_deg(found.R_camera_laser, left_right.R_camera_laser) < 0.5 * kLargest_deg) {
      return "the pictures are mirrored left to right, or the camera is mounted upside down, in "
             "contrast to camera.phi_rad (a scanner with one plane cannot distinguish them)";
    }
    return fmt::format("the camera is rotated by {:.0f} deg relative to camera.phi_rad",
                       turned_deg);
  }
  const RigidExtrinsics top_bottom = mirrored(stated, {1.0, -1.0, 1.0});
  const double off_m = (found.delta_m - stated.delta_m).norm();
  if (off_m > kOtherSide_m && (found.delta_m - top_bottom.delta_m).norm() < 0.3 * off_m) {
    return "the pictures are mirrored top to bottom, or the laser is on the other side of the "
           "camera than camera.delta_m states (a scanner with one plane cannot distinguish them)";
  }
  return {};
}

}  // namespace orchard::calibration
