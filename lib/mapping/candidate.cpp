// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/candidate.hpp"

#include <mrpt/poses/CPose3D.h>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/angles.hpp"
#include "geometry/pose2.hpp"
#include "geometry/symmetric.hpp"

namespace orchard::mapping {

PoseComposition::PoseComposition(const pose::PoseEstimate& pose) : x_m_(pose.x_m), y_m_(pose.y_m) {
  const mrpt::poses::CPose3D T_map_base(pose.x_m, pose.y_m, 0.0, pose.yaw_rad, pose.pitch_rad,
                                        pose.roll_rad);
  const auto& rotation = T_map_base.getRotationMatrix();
  xx_ = rotation(0, 0);
  xy_ = rotation(0, 1);
  yx_ = rotation(1, 0);
  yy_ = rotation(1, 1);
}

namespace {

constexpr double kFanSigmas = 3.0;  ///< derived: range of rotations tried, to each side
constexpr int kFanStepsMax = 30;    ///< derived: to each side

constexpr int kRefinements = 5;

double kernel(double distance_m, double width_m) {
  const double u = distance_m / width_m;
  return std::exp(-0.5 * u * u);
}

}  // namespace

Eigen::Vector2d ScanAlignment::apply(const Eigen::Vector2d& p_map,
                                     const Eigen::Vector2d& robot_map) const {
  return robot_map + x_y_yaw.head<2>() + geometry::rotation(x_y_yaw.z()) * (p_map - robot_map);
}

ScanAlignment align_scan(const std::vector<AlignmentPoint>& points,
                         const Eigen::Vector2d& robot_map, const Eigen::Matrix3d& pose_covariance,
                         double kernel_m, const NearestLandmark& nearest) {
  ScanAlignment alignment;
  alignment.covariance = pose_covariance;
  if (points.size() < 2) return alignment;
  const double yaw_sd_rad = std::sqrt(std::max(0.0, pose_covariance(2, 2)));
  const double reach_m = 3.0 * kernel_m;

  double farthest_m = 0.0;
  for (const AlignmentPoint& point : points) {
    farthest_m = std::max(farthest_m, (point.p_map - robot_map).norm());
  }
  // One step of rotation moves the farthest point by half a kernel.
  const double step_rad = 0.5 * kernel_m / std::max(farthest_m, kernel_m);
  const int steps =
      std::min(kFanStepsMax, static_cast<int>(std::ceil(kFanSigmas * yaw_sd_rad / step_rad)));
  if (steps > 1) {
    double best_score = -1.0;
    double best_yaw_rad = 0.0;
    for (int k = 0; k <= 2 * steps; ++k) {
      // Order 0, +1, -1, +2, ...: the smallest rotation wins among equal scores.
      const double yaw_rad = (k % 2 ? 1 : -1) * ((k + 1) / 2) * kFanSigmas * yaw_sd_rad / steps;
      ScanAlignment trial;
      trial.x_y_yaw.z() = yaw_rad;
      double score = 0.0;
      for (const AlignmentPoint& point : points) {
        const Eigen::Vector2d p = trial.apply(point.p_map, robot_map);
        if (const auto l = nearest(p, reach_m)) score += kernel((*l - p).norm(), kernel_m);
      }
      const double deviation = yaw_rad / yaw_sd_rad;
      score -= 0.05 * deviation * deviation;
      if (score > best_score + 1e-12) {
        best_score = score;
        best_yaw_rad = yaw_rad;
      }
    }
    alignment.x_y_yaw.z() = best_yaw_rad;
  }

  Eigen::Matrix3d prior = pose_covariance;
  prior.diagonal() += Eigen::Vector3d(1e-8, 1e-8, 1e-10);
  const Eigen::Matrix3d prior_information = prior.inverse();
  for (int round = 0; round < kRefinements; ++round) {
    Eigen::Matrix3d information = prior_information;
    Eigen::Vector3d gradient = -prior_information * alignment.x_y_yaw;
    double support = 0.0;
    for (const AlignmentPoint& point : points) {
      const Eigen::Vector2d p = alignment.apply(point.p_map, robot_map);
      const auto landmark = nearest(p, reach_m);
      if (!landmark) continue;
      const Eigen::Vector2d residual = *landmark - p;
      const double fraction = kernel(residual.norm(), kernel_m);
      const double variance_m2 = point.sd_m * point.sd_m + 0.25 * kernel_m * kernel_m;
      const Eigen::Vector2d arm = p - robot_map - alignment.x_y_yaw.head<2>();
      const Eigen::Matrix<double, 2, 3> jacobian = geometry::point_jacobian(arm);
      information += fraction / variance_m2 * jacobian.transpose() * jacobian;
      gradient += fraction / variance_m2 * jacobian.transpose() * residual;
      support += fraction;
    }
    if (support < 1.5) {
      alignment.x_y_yaw.setZero();
      alignment.covariance = pose_covariance;
      return alignment;
    }
    alignment.x_y_yaw += geometry::solve_symmetric(information, gradient);
    alignment.covariance = information.inverse();
  }
  return alignment;
}

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
