// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pose/scan_matching/point_map.hpp"
#include "pose/scan_matching/scan_motion_config.hpp"
#include "pose/scan_matching/surface_points.hpp"

namespace orchard::pose {

/// Distance of a point from the map's surface that counts as a good fit [m].
inline constexpr double kScoreKernel_m = 0.15;

/// Where a scan fits the local map.
struct ScanMatch {
  Eigen::Vector3d T_map_base = Eigen::Vector3d::Zero();
  double score = 0.0;    ///< how well the points fit, 0 to 1
  double matched = 0.0;  ///< fraction of the points that have a partner
  /// Of (x, y) in map and the turn about the robot, in units of one over the residual variance;
  /// without what smooth surfaces say along themselves.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  double residual_variance_m2 = 0.0;
  double weight = 0.0;  ///< of all pairs together; a pair without residual has 1
};

/// Finds the place of a scan in the local map: robust iterated closest points, to lines on smooth
/// surfaces and to points elsewhere (after Censi's PL-ICP and KISS-ICP), with a search of the
/// neighbourhood where that ends in a bad fit.
class ScanMatcher {
 public:
  ScanMatcher(const PointMap& map, const ScanMotionConfig& config) : map_(map), config_(config) {}

  /// The best fit from the best of some guesses (there must be one).
  ScanMatch match(const std::vector<SurfacePoint>& points,
                  const std::vector<Eigen::Vector3d>& guesses) const;

  /// The fit that a guess leads to, without a search.
  ScanMatch refined(const std::vector<SurfacePoint>& points, const Eigen::Vector3d& guess) const;

  /// How well the points fit at a place: the mean over them of exp(-d^2 / 2 kernel^2).
  double score(const std::vector<SurfacePoint>& points, const Eigen::Vector3d& T_map_base,
               double kernel_m) const;

 private:
  void iterate(const std::vector<SurfacePoint>& points, double pair_m, double kernel_m,
               ScanMatch& match) const;
  ScanMatch searched(const std::vector<SurfacePoint>& points, const Eigen::Vector3d& centre,
                     double turn_rad, const ScanMatch& found) const;

  const PointMap& map_;
  const ScanMotionConfig& config_;
};

}  // namespace orchard::pose
