// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/extrinsics/observability.hpp"

#include <fmt/core.h>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/angles.hpp"

namespace orchard::calibration {
namespace {

constexpr double kDeg = geometry::kPi / 180.0;
constexpr double kMinSpread = 0.05;  ///< min spread of the normals: 3 degrees
constexpr double kSameOrientation_rad = 6.0 * kDeg;
constexpr double kMoved_m = 0.05;

/// Variance of a normal's direction in one of the two directions perpendicular to it.
double normal_variance(const BoardPose& board) {
  return 0.5 * board.covariance.topLeftCorner<3, 3>().trace();
}

}  // namespace

BoardMotion board_motion(const std::vector<BoardPose>& boards) {
  BoardMotion motion;
  if (boards.empty()) return motion;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  double noise = 0.0;
  std::vector<Eigen::Vector3d> orientations;
  motion.distance_min_m = motion.distance_max_m = boards.front().distance_m();
  for (const BoardPose& board : boards) {
    const Eigen::Vector3d n = board.normal_camera();
    scatter += n * n.transpose();
    noise += normal_variance(board);
    motion.distance_min_m = std::min(motion.distance_min_m, board.distance_m());
    motion.distance_max_m = std::max(motion.distance_max_m, board.distance_m());
    for (const BoardPose& other : boards) {
      const double cosine = std::clamp(n.dot(other.normal_camera()), -1.0, 1.0);
      motion.tilt_max_deg = std::max(motion.tilt_max_deg, std::acos(cosine) / kDeg);
      motion.moved_m =
          std::max(motion.moved_m, (board.t_camera_board_m - other.t_camera_board_m).norm());
    }
    const double near = kSameOrientation_rad + 2.0 * std::sqrt(normal_variance(board));
    const bool known =
        std::any_of(orientations.begin(), orientations.end(), [&](const Eigen::Vector3d& o) {
          return std::acos(std::clamp(o.dot(n), -1.0, 1.0)) < near;
        });
    if (!known) orientations.push_back(n);
  }
  const double count = static_cast<double>(boards.size());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter / count);
  const Eigen::Vector3d spread = (solver.eigenvalues().array() - noise / count).cwiseMax(0.0);
  motion.out_of_plane = std::sqrt(spread[0]);
  motion.out_of_line = std::sqrt(spread[1]);
  motion.axis_camera = solver.eigenvectors().col(0);
  motion.num_orientations = static_cast<int>(orientations.size());
  return motion;
}

std::string camera_direction(const Eigen::Vector3d& direction_camera) {
  static constexpr std::array<const char*, 3> kNames{
      "the camera's x axis (right)", "the camera's y axis (down)", "the camera's z axis (forward)"};
  const Eigen::Vector3d d = direction_camera.normalized();
  int axis = 0;
  d.cwiseAbs().maxCoeff(&axis);
  if (std::abs(d[axis]) > 0.85) return kNames[static_cast<std::size_t>(axis)];
  return fmt::format("the direction ({:.2f}, {:.2f}, {:.2f}) of the camera frame", d.x(), d.y(),
                     d.z());
}

std::string degenerate_motion(const BoardMotion& motion) {
  if (motion.out_of_plane >= kMinSpread) return {};
  constexpr double kHardlyTilted_deg = 16.0;
  if (motion.out_of_line < kMinSpread || motion.tilt_max_deg < kHardlyTilted_deg) {
    if (motion.moved_m < kMoved_m) {
      return "the board never moved, so most of the six unknowns are not determined; hold it in "
             "other places, tilted to all sides";
    }
    return fmt::format(
        "the board was always (nearly) parallel to itself, tilted by {:.1f} deg at most between "
        "two views, so translations along it are not determined; tilt it by 20 to 45 deg to the "
        "left and right, forward and back",
        motion.tilt_max_deg);
  }
  if (motion.num_orientations == 2) {
    return fmt::format("the board was held in two orientations only ({:.0f} deg apart): ",
                       motion.tilt_max_deg) +
           "the translation along " + camera_direction(motion.axis_camera) +
           ", the intersection of the two planes, is not determined; hold it in more orientations";
  }
  const Eigen::Vector3d across = motion.axis_camera.cwiseAbs();
  const char* advice = across.y() > 0.7   ? "tilt it forward and back, too"
                       : across.x() > 0.7 ? "turn it to the left and right, too"
                                          : "tilt it about a second axis, too";
  return "all boards were tilted about one axis only, " + camera_direction(motion.axis_camera) +
         ": the translation along that axis is not determined; " + advice;
}

std::string undetermined_direction(const Eigen::Matrix<double, 6, 6>& covariance,
                                   double shift_sd_max_m, double turn_sd_max_rad,
                                   const BoardMotion& motion) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> shift(
      Eigen::Matrix3d(covariance.topLeftCorner<3, 3>()));
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> turn(
      Eigen::Matrix3d(covariance.bottomRightCorner<3, 3>()));
  const double shift_sd_m = std::sqrt(std::max(0.0, shift.eigenvalues()[2]));
  const double turn_sd_rad = std::sqrt(std::max(0.0, turn.eigenvalues()[2]));
  std::string what;
  if (!(shift_sd_m <= shift_sd_max_m)) {
    what = "the translation along " + camera_direction(shift.eigenvectors().col(2)) +
           fmt::format(
               " is not determined (standard deviation {:.0f} mm, but at most {:.0f} is allowed)",
               1e3 * shift_sd_m, 1e3 * shift_sd_max_m);
  } else if (!(turn_sd_rad <= turn_sd_max_rad)) {
    what = "the rotation about " + camera_direction(turn.eigenvectors().col(2)) +
           fmt::format(
               " is not determined (standard deviation {:.2f} deg, but at most {:.2f} is allowed)",
               turn_sd_rad / kDeg, turn_sd_max_rad / kDeg);
  } else {
    return {};
  }
  if (motion.tilt_max_deg < 25.0) {
    return what +
           fmt::format(
               "; the board was tilted by {:.0f} deg at most between two views: tilt it more",
               motion.tilt_max_deg);
  }
  if (motion.out_of_plane < 0.15) {
    return what +
           "; the board was hardly tilted about a second axis: tilt it forward and back, too";
  }
  if (motion.distance_max_m < 1.15 * motion.distance_min_m) {
    return what + "; the distance of the board never changed: hold it nearer and farther, too";
  }
  return what + "; hold the board in more places and orientations";
}

}  // namespace orchard::calibration
