// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/scan_alignment.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "geometry/pose2.hpp"

namespace orchard::mapping {
namespace {

constexpr double kFanSigmas = 3.0;  ///< range of rotations tried, to each side
constexpr int kFanStepsMax = 30;    ///< to each side
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
    alignment.x_y_yaw += information.ldlt().solve(gradient);
    alignment.covariance = information.inverse();
  }
  return alignment;
}

}  // namespace orchard::mapping
