// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/candidate.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/angles.hpp"
#include "geometry/pose2.hpp"

namespace orchard::mapping {
namespace {

using detection::Detection;

Eigen::Matrix3d matrix_of(const std::array<double, 6>& c) {
  Eigen::Matrix3d m;
  m << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  return m;
}

/// Covariance in map of a point at offset `arm` from the robot, caused by `pose_covariance`.
Eigen::Matrix2d swept(const Eigen::Matrix3d& pose_covariance, const Eigen::Vector2d& arm) {
  const Eigen::Matrix<double, 2, 3> jacobian = geometry::point_jacobian(arm);
  return jacobian * pose_covariance * jacobian.transpose();
}

}  // namespace

std::vector<Candidate> compose(const detection::Detections& detections,
                               const pose::PoseEstimate& pose, const PoseComposition& composition,
                               double observation_range_max_m) {
  const Eigen::Vector2d robot(pose.x_m, pose.y_m);
  const Eigen::Matrix3d pose_covariance = matrix_of(pose.covariance);
  const Eigen::Matrix2d rotation = geometry::rotation(pose.yaw_rad);
  std::vector<Candidate> candidates;
  candidates.reserve(detections.trunks.size());
  for (const Detection& d : detections.trunks) {
    if (std::hypot(d.centre_x_m, d.centre_y_m) > observation_range_max_m) continue;
    Candidate candidate;
    candidate.detection = &d;
    candidate.p_map = composition.apply(d.centre_x_m, d.centre_y_m);
    if (!candidate.p_map.allFinite() || candidate.p_map.cwiseAbs().maxCoeff() > 1e9) continue;
    candidate.p_aligned = candidate.p_map;
    Eigen::Matrix2d own;
    own << d.covariance[0], d.covariance[1], d.covariance[1], d.covariance[2];
    own = rotation * own * rotation.transpose();
    own.diagonal().array() += 1e-6;  // floor of 1 mm
    candidate.covariance = own + swept(pose_covariance, candidate.p_map - robot);
    candidate.aligned_covariance = candidate.covariance;
    candidates.push_back(candidate);
  }
  return candidates;
}

pose::PoseEstimate align(std::vector<Candidate>& candidates, const pose::PoseEstimate& pose,
                         double kernel_m, const NearestLandmark& nearest) {
  const Eigen::Vector2d robot(pose.x_m, pose.y_m);
  const Eigen::Matrix3d pose_covariance = matrix_of(pose.covariance);
  std::vector<AlignmentPoint> points;
  for (const Candidate& c : candidates) {
    if (c.detection->label == detection::Label::kObject) continue;
    const Eigen::Matrix2d own = c.covariance - swept(pose_covariance, c.p_map - robot);
    points.push_back({c.p_map, std::sqrt(std::max(1e-8, 0.5 * own.trace()))});
  }
  const ScanAlignment alignment = align_scan(points, robot, pose_covariance, kernel_m, nearest);
  for (Candidate& c : candidates) {
    const Eigen::Vector2d arm = c.p_map - robot;
    c.p_aligned = alignment.apply(c.p_map, robot);
    c.aligned_covariance =
        c.covariance - swept(pose_covariance, arm) + swept(alignment.covariance, arm);
  }
  pose::PoseEstimate aligned = pose;
  aligned.x_m += alignment.x_y_yaw.x();
  aligned.y_m += alignment.x_y_yaw.y();
  aligned.yaw_rad = geometry::wrap_angle_rad(pose.yaw_rad + alignment.x_y_yaw.z());
  const Eigen::Matrix3d& c = alignment.covariance;
  aligned.covariance = {c(0, 0), c(0, 1), c(0, 2), c(1, 1), c(1, 2), c(2, 2)};
  return aligned;
}

double pose_induced_sd_m(const pose::PoseEstimate& pose, const Eigen::Vector2d& p_map) {
  const Eigen::Vector2d arm = p_map - Eigen::Vector2d(pose.x_m, pose.y_m);
  return std::sqrt(std::max(0.0, 0.5 * swept(matrix_of(pose.covariance), arm).trace()));
}

}  // namespace orchard::mapping
