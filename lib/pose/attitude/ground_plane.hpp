// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "laser/scan.hpp"
#include "pose/attitude/attitude.hpp"

namespace orchard::pose {

/// The ground about the robot as far as its own tilt tells: the plane that fits the way driven
/// lately, and how far from it the ground may be. A bump tilts the robot, not the plane, so a beam
/// that goes down relative to the plane is known to meet the ground.
class GroundPlane {
 public:
  /// `memory_m`: distance driven after which a tilt is forgotten, the reach of what is asked.
  explicit GroundPlane(double memory_m) : memory_m_(memory_m) {}

  /// Takes the tilt after a step of `distance_m` and a turn of `turn_rad`.
  void add(const Attitude& attitude, double distance_m, double turn_rad);

  /// Rise of the plane per metre along the level frame's x and y.
  const Eigen::Vector2d& gradient() const { return gradient_; }

  /// The ground below a plane that starts `height_m` above it and rises by `rise` per metre: how
  /// high above it a beam of a robot that is level with it meets things.
  laser::OverGround below(double height_m, const Eigen::Vector2d& rise) const;

 private:
  double memory_m_;
  bool is_started_ = false;
  Eigen::Vector2d gradient_ = Eigen::Vector2d::Zero();
  double variance_ = 0.0;  ///< of each component about the plane [m2/m2]
  double driven_m_ = 0.0;
};

}  // namespace orchard::pose
