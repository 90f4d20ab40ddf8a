// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace orchard::evaluation {

/// A point of the map frame.
struct Point {
  double x_m = 0.0;
  double y_m = 0.0;

  Point() = default;
  Point(double x, double y) : x_m(x), y_m(y) {}
  Point(const Eigen::Vector2d& p) : x_m(p.x()), y_m(p.y()) {}
  operator Eigen::Vector2d() const { return {x_m, y_m}; }
};

/// For each true point the index of its found point, or kUnmatched.
using Assignment = std::vector<std::ptrdiff_t>;
inline constexpr std::ptrdiff_t kUnmatched = -1;

/// Pairs true points with found points, one to one, at most `gate_m` apart.
///
/// Among all such pairings, selects one with the most pairs, and among those the one with the
/// smallest sum of squared distances, so a duplicate landmark never displaces a better one.
/// Deterministic. Cost: cubic in the largest cluster of points closer than the gate, not in the
/// map. Throws std::invalid_argument for a gate that is not positive or a point that is not finite.
Assignment assign(const std::vector<Point>& truth, const std::vector<Point>& found, double gate_m);

}  // namespace orchard::evaluation
