// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace orchard::mapping {

/// A polyline in map [m].
using Line = std::vector<Eigen::Vector2d>;

/// A point of a line with the line's direction there (unit vector).
struct LinePoint {
  Eigen::Vector2d p{0, 0};
  Eigen::Vector2d along{1, 0};
};

/// Unit vector to the right of a direction.
inline Eigen::Vector2d right_of(const Eigen::Vector2d& along) { return {along.y(), -along.x()}; }

double length_m(const Line& line);

/// Points along a line, evenly spaced by at most `step_m`, including both ends; empty for a line of
/// zero length.
std::vector<LinePoint> sample_line(const Line& line, double step_m);

}  // namespace orchard::mapping
