// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

namespace orchard::geometry {

/// Camera intrinsics with the names of Bouguet's toolbox (Shalal et al. 2013, section 3.2).
struct CameraIntrinsics {
  int width_px = 320;
  int height_px = 240;
  std::array<double, 2> fc_px{250.0, 250.0};  ///< focal lengths
  std::array<double, 2> cc_px{159.5, 119.5};  ///< principal point
  double alpha_c = 0.0;                       ///< skew
  std::array<double, 5> kc{};                 ///< k1 k2 p1 p2 k3, in Bouguet's and OpenCV's order
};

/// Pinhole camera with distortion: projects points of the camera frame to pixels; pixel centres are
/// whole numbers.
///
/// project() returns none for points behind the camera and outside the undistorted field of view,
/// where the distortion polynomial folds back; its pixels may lie outside the image. Source: Shalal
/// et al. 2013, eqs. 3-7.
class CameraModel {
 public:
  explicit CameraModel(const CameraIntrinsics& intrinsics);

  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p_camera) const;
  bool in_image(const Eigen::Vector2d& pixel) const;
  const CameraIntrinsics& intrinsics() const { return intrinsics_; }

  /// Normalized coordinates (x, y at z = 1) of a pixel: inverts eqs. 4-7 by iteration.
  Eigen::Vector2d undistort(const Eigen::Vector2d& pixel) const;

 private:
  Eigen::Vector2d distort(const Eigen::Vector2d& normalized) const;

  CameraIntrinsics intrinsics_;
  double max_radius_ = 0.0;  ///< normalized radius up to which distortion is monotonic
};

}  // namespace orchard::geometry
