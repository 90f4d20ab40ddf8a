// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pose/pose_config.hpp"
#include "pose/scan_matching/point_map.hpp"
#include "pose/tuning.hpp"

namespace orchard::pose {

/// Kernel width of the final score [m]: scale of the distance between a point and the map; derived:
/// half of kKernel_m.
inline constexpr double kScoreKernel_m = 0.15;

/// Result of registering a scan to the local map.
struct ScanMatch {
  Eigen::Vector3d T_map_base = Eigen::Vector3d::Zero();
  double score = 0.0;    ///< how well the points fit, 0 to 1
  double matched = 0.0;  ///< fraction of the points that have a partner
  /// Information on (x, y) in map and the rotation about the robot, to be divided by the residual
  /// variance; smooth surfaces give none along themselves.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  double residual_variance_m2 = 0.0;
  double weight = 0.0;  ///< sum over all pairs; a pair without residual has weight 1
};

/// Registers a scan to the local map by robust ICP: point-to-line on smooth surfaces,
/// point-to-point elsewhere (after Censi's PL-ICP and KISS-ICP). After a bad fit it searches
/// all turns and the neighbourhood, wider if nothing there fits; among fits that are as good, the
/// predicted pose is kept.
class ScanMatcher {
 public:
  ScanMatcher(const PointMap& map, const ScanMotionConfig& config) : map_(map), config_(config) {}

  /// Registers the points, starting from the best of the guesses of T_map_base (at least one).
  ScanMatch match(const std::vector<SurfacePoint>& points,
                  const std::vector<Eigen::Vector3d>& guesses) const;

  /// Registers the points from one guess by ICP, without a search.
  ScanMatch refined(const std::vector<SurfacePoint>& points, const Eigen::Vector3d& guess) const;

  /// Returns the fit of the points at a pose: the mean of exp(-d^2 / (2 kernel_m^2)) over the
  /// points, with d the distance to the nearest point of the map.
  double score(const std::vector<SurfacePoint>& points, const Eigen::Vector3d& T_map_base,
               double kernel_m) const;

 private:
  void iterate(const std::vector<SurfacePoint>& points, double pair_m, double kernel_m,
               ScanMatch& match) const;
  ScanMatch searched(const std::vector<SurfacePoint>& points, const Eigen::Vector3d& centre,
                     double shift_m, const ScanMatch& found) const;

  /// A pose that the points do not determine.
  ScanMatch unmatched(const std::vector<SurfacePoint>& points,
                      const Eigen::Vector3d& T_map_base) const;
  const PointMap& map_;
  const ScanMotionConfig& config_;
};

/// Returns the covariance of a fit: of (x, y) in map and the rotation about the robot.
///
/// It is computed from the information of the pairs and their residuals. Along each axis the
/// information is limited to the actual loss of fit when the scan is shifted, because in a dense
/// map every point finds a partner nearby, also along a hedge. Undetermined directions keep the
/// covariance of unknown_motion().
Eigen::Matrix3d covariance_of(const ScanMatcher& matcher, const std::vector<SurfacePoint>& points,
                              const ScanMatch& match);

/// Returns the pose of a fit, with the predicted position in directions that the scan does not
/// determine, if the fit has slid along them, e.g. along a hedge (solution remapping: Zhang, Kaess,
/// Singh 2016).
Eigen::Vector3d remap_pose(const ScanMatch& match, const Eigen::Matrix3d& covariance,
                           const Eigen::Vector3d& T_map_expected);

/// Returns the covariance of a motion that is only predicted.
Eigen::Matrix3d unknown_motion();

}  // namespace orchard::pose
