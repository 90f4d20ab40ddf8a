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

/// Laser-camera extrinsics in the form of Kassir and Peynot's toolbox (Shalal et al. 2013, section
/// 3.2).
struct LaserCameraExtrinsics {
  std::array<double, 3> delta_m{};  ///< laser origin in the camera frame
  std::array<double, 3> phi_rad{};  ///< angles about x, y, z of eq. 2
};

/// The paper's rotation matrix Phi: p_laser = Phi (p_camera - delta), equal to
/// (Rx(phi_x) Ry(phi_y) Rz(phi_z))^T. Not MRPT's yaw-pitch-roll order.
/// Source: Shalal et al. 2013, eq. 2.
Eigen::Matrix3d paper_rotation(const std::array<double, 3>& phi_rad);

/// The angles of eq. 2 for a rotation from laser to camera: the inverse of
/// LaserToCamera::rotation(), phi_y in [-pi/2, pi/2]. At phi_y = +-pi/2 only the sum or difference
/// of the other two is determined, and phi_z is 0.
std::array<double, 3> paper_angles_rad(const Eigen::Matrix3d& R_camera_laser);

/// T_camera_laser: transforms points of the laser frame to the camera frame. Source: the inverse of
/// Shalal et al. 2013, eq. 1.
class LaserToCamera {
 public:
  explicit LaserToCamera(const LaserCameraExtrinsics& extrinsics);

  Eigen::Vector3d operator()(const Eigen::Vector3d& p_laser) const {
    // Shalal et al. 2013, eq. 1, solved for p_camera.
    return R_camera_laser_ * p_laser + delta_m_;
  }
  const Eigen::Matrix3d& rotation() const { return R_camera_laser_; }
  const Eigen::Vector3d& translation_m() const { return delta_m_; }

 private:
  Eigen::Matrix3d R_camera_laser_;
  Eigen::Vector3d delta_m_;
};

/// The camera of a rig: intrinsics, extrinsics, delay. Section `camera`.
struct CameraConfig {
  bool enabled = true;
  /// Fixed delay of the camera: the exposure is this much earlier than the picture's utime.
  double delay_s = 0.0;
  CameraIntrinsics intrinsics;
  LaserCameraExtrinsics extrinsics{{0.0, -0.06, 0.0},
                                   {1.5707963267948966, 0.0, 1.5707963267948966}};
};

template <class Visitor>
void describe(Visitor& v, CameraConfig& c) {
  v.flag("enabled", c.enabled, "false for a rig without a camera: detection by the laser only");
  v.number("delay_s", c.delay_s, -0.5, 0.5, "s",
           "time from the exposure of a picture to its utime; from `orchard calibrate delay`");
  v.integer("width_px", c.intrinsics.width_px, 16, 8192, "px", "width of the pictures");
  v.integer("height_px", c.intrinsics.height_px, 16, 8192, "px", "height of the pictures");
  v.numbers("fc_px", c.intrinsics.fc_px, 1, 1e5, "px",
            "focal lengths x, y; from `orchard calibrate camera`");
  v.numbers("cc_px", c.intrinsics.cc_px, -1e4, 1e4, "px",
            "principal point x, y; from `orchard calibrate camera`");
  v.expert().number("alpha_c", c.intrinsics.alpha_c, -1, 1, "1",
                    "skew; from `orchard calibrate camera`");
  v.numbers("kc", c.intrinsics.kc, -100, 100, "1",
            "distortion k1, k2, p1, p2, k3; from `orchard calibrate camera`");
  v.numbers("delta_m", c.extrinsics.delta_m, -10, 10, "m",
            "origin of the laser in the camera frame; from `orchard calibrate laser-camera`");
  v.numbers("phi_rad", c.extrinsics.phi_rad, -6.2832, 6.2832, "rad",
            "rotation of the laser to the camera about x, y, z (paper, eq. 2); from `orchard "
            "calibrate laser-camera`");
}

}  // namespace orchard::geometry
