// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/board/board_pose.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <utility>

#include "geometry/statistics.hpp"

namespace orchard::calibration {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

// derived: four standard deviations of chi2 with one degree of freedom.
constexpr double kClearlyWorse = 16.0;  ///< min increase of chi2 for a pose to be clearly worse

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// Undistorted corners in normalized coordinates (z = 1).
struct Corners {
  std::vector<Eigen::Vector2d> normalized;
  std::vector<Eigen::Vector2d> board_m;
  double focal_px = 1.0;
};

/// Sets the pose's covariance for corners with a noise of 1 px; returns the sum of squares [px^2],
/// infinite if a corner is behind the camera.
double judge(const Corners& corners, BoardPose& pose) {
  Matrix6 normal = Matrix6::Zero();
  double sum = 0.0;
  for (std::size_t i = 0; i < corners.board_m.size(); ++i) {
    const Eigen::Vector3d board(corners.board_m[i].x(), corners.board_m[i].y(), 0.0);
    const Eigen::Vector3d turned = pose.R_camera_board * board;
    const Eigen::Vector3d p = turned + pose.t_camera_board_m;
    if (p.z() <= 1e-6) return std::numeric_limits<double>::infinity();
    const Eigen::Vector2d error = corners.focal_px * (p.head<2>() / p.z() - corners.normalized[i]);
    Eigen::Matrix<double, 2, 3> projection;
    projection << 1.0, 0.0, -p.x() / p.z(), 0.0, 1.0, -p.y() / p.z();
    projection *= corners.focal_px / p.z();
    Eigen::Matrix<double, 2, 6> jacobian;
    jacobian.leftCols<3>() = -projection * cross_matrix(turned);
    jacobian.rightCols<3>() = projection;
    normal += jacobian.transpose() * jacobian;
    sum += error.squaredNorm();
  }
  pose.covariance = normal.ldlt().solve(Matrix6::Identity());
  return sum;
}

}  // namespace

Eigen::Matrix3d rotation_of(const Eigen::Vector3d& turn) {
  const double angle = turn.norm();
  if (angle < 1e-15) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
}

Eigen::Vector3d BoardPose::normal_camera() const {
  const Eigen::Vector3d z = R_camera_board.col(2);
  return z.dot(t_camera_board_m) < 0.0 ? Eigen::Vector3d(-z) : z;
}

double BoardPose::distance_m() const { return normal_camera().dot(t_camera_board_m); }

std::optional<BoardPose> estimate_board_pose(const std::vector<Eigen::Vector2d>& corners_px,
                                             const std::vector<Eigen::Vector2d>& corners_m,
                                             const geometry::CameraModel& camera,
                                             double corner_sd_px) {
  if (corners_px.size() != corners_m.size() || corners_px.size() < 6) return std::nullopt;
  Corners corners;
  corners.board_m = corners_m;
  // One scale for both axes: the difference of the focal lengths is far below the uncertainty of
  // the noise.
  corners.focal_px = 0.5 * (camera.intrinsics().fc_px[0] + camera.intrinsics().fc_px[1]);
  std::vector<cv::Point3d> object;
  std::vector<cv::Point2d> image;
  for (std::size_t i = 0; i < corners_px.size(); ++i) {
    corners.normalized.push_back(camera.undistort(corners_px[i]));
    if (!corners.normalized.back().allFinite()) return std::nullopt;
    object.emplace_back(corners_m[i].x(), corners_m[i].y(), 0.0);
    image.emplace_back(corners.normalized.back().x(), corners.normalized.back().y());
  }

  // The two solutions of IPPE (Collins and Bartoli), each refined to its own minimum.
  std::vector<cv::Mat> turns, shifts;
  try {
    cv::solvePnPGeneric(object, image, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), turns, shifts,
                        false, cv::SOLVEPNP_IPPE);
  } catch (const cv::Exception&) {
    return std::nullopt;  // corners on one line
  }
  BoardPose best;
  double best_sum = std::numeric_limits<double>::infinity();
  double second_sum = best_sum;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    BoardPose pose;
    const auto vector_of = [](const cv::Mat& m) {
      return Eigen::Vector3d(m.at<double>(0), m.at<double>(1), m.at<double>(2));
    };
    cv::solvePnPRefineLM(object, image, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), turns[i],
                         shifts[i], {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 40, 1e-12});
    pose.R_camera_board = rotation_of(vector_of(turns[i]));
    pose.t_camera_board_m = vector_of(shifts[i]);
    const double sum = judge(corners, pose);
    if (sum < best_sum) {
      const bool same = std::isfinite(best_sum) &&
                        best.R_camera_board.col(2).dot(pose.R_camera_board.col(2)) > 0.9999;
      if (!same) second_sum = best_sum;
      best_sum = sum;
      best = pose;
    } else if (best.R_camera_board.col(2).dot(pose.R_camera_board.col(2)) <= 0.9999) {
      second_sum = std::min(second_sum, sum);
    }
  }
  if (!std::isfinite(best_sum) || !best.covariance.allFinite()) return std::nullopt;
  best.num_corners = static_cast<int>(corners_px.size());
  best.rms_px = std::sqrt(best_sum / (2.0 * best.num_corners));
  best.covariance *= corner_sd_px * corner_sd_px;
  best.second_squares_px2 = second_sum - best_sum;
  best.ambiguous = best.second_squares_px2 < kClearlyWorse * corner_sd_px * corner_sd_px;
  return best;
}

std::vector<std::optional<BoardPose>> estimate_board_poses(const std::vector<BoardView>& views,
                                                           const geometry::CameraModel& camera) {
  std::vector<std::optional<BoardPose>> poses;
  std::vector<double> variances;
  for (const BoardView& view : views) {
    poses.push_back(estimate_board_pose(view.corners_px, view.corners_m, camera, 1.0));
    if (!poses.back()) continue;
    const double left_over = 2.0 * poses.back()->num_corners;
    variances.push_back(poses.back()->rms_px * poses.back()->rms_px * left_over /
                        std::max(1.0, left_over - 6.0));
  }
  if (variances.empty()) return poses;
  // The median over the images is robust against a few wrong ones.
  const double variance = std::max(0.02 * 0.02, geometry::median(std::move(variances)));
  for (auto& pose : poses) {
    if (!pose) continue;
    pose->covariance *= variance;
    pose->ambiguous = pose->second_squares_px2 < kClearlyWorse * variance;
  }
  return poses;
}

}  // namespace orchard::calibration
