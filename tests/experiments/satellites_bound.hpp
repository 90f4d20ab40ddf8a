// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "io/config/config.hpp"
#include "pose/measurements.hpp"
#include "simulation/scene/drive_path.hpp"

namespace orchard {

/// A satellite position in the datum's plane [m], east and north.
struct PlacedFix {
  double time_s = 0.0;
  Eigen::Vector2d p_map_m = Eigen::Vector2d::Zero();
};

/// One pose of the bound's path.
struct BoundPose {
  double time_s = 0.0;
  Eigen::Vector2d told_m = Eigen::Vector2d::Zero();  ///< from the data up to then
  Eigen::Vector2d p_map_m = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of p_map_m [m2]
};

/// Smooths a simulated drive knowing what no program can know: the true noise model of wheels and
/// receiver, which fixes are reflected (`fixes` are the others), and the true path, about which the
/// motion is linearised. No estimator does better on average, so it bounds what data of a rig give.
/// Source: Rauch, Tung and Striebel 1965, Maximum likelihood estimates of linear dynamic systems.
std::vector<BoundPose> bound_of(const io::Config& config, const simulation::DrivePath& truth,
                                const std::vector<pose::Odometry>& odometry,
                                const std::vector<PlacedFix>& fixes);

/// Returns the small transform [m, m, rad] by which a map without any error of its own would be off
/// once it is registered to `fixes` (those not reflected) with the receiver's true noise model: the
/// receiver's slow error is common to the whole map. Bounds mode slam with fixes.
Eigen::Vector3d map_bound_of(const io::Config& config, const simulation::DrivePath& truth,
                             const std::vector<PlacedFix>& fixes);

}  // namespace orchard
