// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace orchard::mapping {

/// Points of the map frame [m], joined by straight pieces.
using Line = std::vector<Eigen::Vector2d>;

/// A point of a line, and which way the line goes there (a unit vector).
struct LinePoint {
  Eigen::Vector2d p{0, 0};
  Eigen::Vector2d along{1, 0};
};

/// To the right of a direction.
inline Eigen::Vector2d right_of(const Eigen::Vector2d& along) { return {along.y(), -along.x()}; }

double length_m(const Line& line);

/// Points along a line at even steps of `step_m` at most, its ends among them; none of a line
/// without length.
std::vector<LinePoint> walked(const Line& line, double step_m);

}  // namespace orchard::mapping
