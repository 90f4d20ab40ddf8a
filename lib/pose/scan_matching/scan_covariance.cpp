// SPDX-License-Identifier: BSD-3-Clause
#include "pose/scan_matching/scan_covariance.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace orchard::pose {
namespace {

/// Min standard deviation of a pair [m], by the roughness of surfaces.
constexpr double kResidualSd_m = 0.02;

/// Number of points that count as one, because errors of neighbouring points are correlated.
constexpr double kCorrelatedPoints = 4.0;

/// Standard deviation of a motion that the scans do not determine [m].
constexpr double kUnknownShiftSd_m = 0.5;

/// The same for its rotation [rad].
constexpr double kUnknownTurnSd_rad = 0.3;

/// Min remaining fraction of the predicted variance for a direction to count as undetermined.
constexpr double kUntoldFraction = 0.25;

/// Shift of the scan to each side, in kernels: informative points keep a fit of
/// exp(-0.5 * 1.5^2) = 0.32.
constexpr double kProbeKernels = 1.5;
/// Apparent informative fraction, by noise, on a surface that is endless along the direction.
constexpr double kFractionByChance = 0.045;

/// Returns the fraction of points that are informative on a shift along a direction, from the loss
/// of fit by that shift.
double telling_fraction(const ScanMatcher& matcher, const std::vector<SurfacePoint>& points,
                        const ScanMatch& match, const Eigen::Vector2d& direction, double kernel_m) {
  const double shift_m = kProbeKernels * kernel_m;
  double drop = 0.0;
  for (const double side : {-1.0, 1.0}) {
    Eigen::Vector3d moved = match.T_map_base;
    moved.head<2>() += side * shift_m * direction;
    drop += 0.5 * (match.score - matcher.score(points, moved, kernel_m));
  }
  const double drop_of_telling = 1.0 - std::exp(-0.5 * kProbeKernels * kProbeKernels);
  return std::clamp((drop / drop_of_telling - kFractionByChance) / (1.0 - kFractionByChance), 0.0,
                    1.0);
}

}  // namespace

Eigen::Matrix3d unknown_motion() {
  return Eigen::Vector3d(kUnknownShiftSd_m * kUnknownShiftSd_m,
                         kUnknownShiftSd_m * kUnknownShiftSd_m,
                         kUnknownTurnSd_rad * kUnknownTurnSd_rad)
      .asDiagonal();
}

Eigen::Vector3d remap_pose(const ScanMatch& match, const Eigen::Matrix3d& covariance,
                           const Eigen::Vector3d& T_map_expected) {
  const Eigen::Vector2d apart = (match.T_map_base - T_map_expected).head<2>();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
  axes.computeDirect(Eigen::Matrix2d(covariance.topLeftCorner<2, 2>()));
  // The rotation is always taken from the fit, because its prediction may be far off.
  Eigen::Vector3d place = match.T_map_base;
  for (int axis = 0; axis < 2; ++axis) {
    const double untold = axes.eigenvalues()(axis) / (kUnknownShiftSd_m * kUnknownShiftSd_m);
    const Eigen::Vector2d direction = axes.eigenvectors().col(axis);
    const bool has_slid = std::abs(apart.dot(direction)) > kUnknownShiftSd_m;
    if (!has_slid || !(untold > kUntoldFraction)) continue;
    place.head<2>() -= apart.dot(direction) * direction;
  }
  return place.allFinite() ? place : match.T_map_base;
}

Eigen::Matrix3d covariance_of(const ScanMatcher& matcher, const std::vector<SurfacePoint>& points,
                              const ScanMatch& match) {
  const Eigen::Matrix3d nothing = unknown_motion();
  const double weight = match.weight;
  if (!(weight > 0.0) || !match.information.allFinite()) return nothing;
  Eigen::Matrix3d information = match.information;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
  axes.computeDirect(match.information.topLeftCorner<2, 2>());
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d direction = axes.eigenvectors().col(axis);
    const double claimed = std::max(0.0, axes.eigenvalues()(axis)) / weight;
    const double fraction = telling_fraction(matcher, points, match, direction, kScoreKernel_m);
    if (!(claimed > 0.0) || fraction >= claimed) continue;
    // Scale the information along the direction (and its correlation) by fraction / claimed.
    Eigen::Matrix3d scale = Eigen::Matrix3d::Identity();
    scale.topLeftCorner<2, 2>() -=
        (1.0 - std::sqrt(fraction / claimed)) * direction * direction.transpose();
    information = scale * information * scale;
  }
  const double floor_m2 = kResidualSd_m * kResidualSd_m;
  const double variance_m2 = kCorrelatedPoints * std::max(match.residual_variance_m2, floor_m2);
  const Eigen::Matrix3d total =
      information / variance_m2 + Eigen::Matrix3d(nothing.diagonal().cwiseInverse().asDiagonal());
  const Eigen::Matrix3d covariance = total.inverse();
  if (!covariance.allFinite()) return nothing;
  return 0.5 * (covariance + covariance.transpose());
}

}  // namespace orchard::pose
