// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "pose/slam/graph.hpp"

namespace ceres {
class CostFunction;
}

/// The terms of the graph's sum of squares, each divided by its standard deviation. Poses are
/// (x, y, yaw) of T_map_base, landmarks (x, y) in map, wheels' errors three numbers. Whoever takes
/// a term owns it.
namespace orchard::pose {

/// Pose against the pose before and the wheels' errors: parameters before, now, errors.
/// `covariance` is of motion.delta, perhaps with what the pose before adds to it.
ceres::CostFunction* motion_term(const RelativeMotion& motion, const Eigen::Matrix3d& covariance);

/// Landmark as a keyframe saw it: parameters pose, landmark.
ceres::CostFunction* sighting_term(const SlamSighting& sighting);

/// Landmark by what older keyframes say of it: parameter landmark.
ceres::CostFunction* place_term(const Eigen::Vector2d& p_map, const Eigen::Matrix2d& covariance);

/// The wheels' errors against a value known before: parameter errors.
ceres::CostFunction* errors_prior_term(const WheelErrors& mean, const Eigen::Matrix3d& covariance);

/// The wheels' errors wander from one stretch of the path to the next: parameters before, after.
ceres::CostFunction* errors_walk_term(const Eigen::Vector3d& sd);

/// Position of a point on base, measured from outside: parameter pose.
ceres::CostFunction* fix_term(const PlaceFix& fix);

/// Heading measured from outside: parameter pose.
ceres::CostFunction* heading_term(const PlaceFix& fix);

}  // namespace orchard::pose
