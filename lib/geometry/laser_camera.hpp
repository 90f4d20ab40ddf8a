// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>

namespace orchard::geometry {

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

}  // namespace orchard::geometry
