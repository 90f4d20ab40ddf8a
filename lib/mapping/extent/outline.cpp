// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/extent/outline.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"

namespace orchard::mapping {
namespace {

/// Chords per half circle; the approximation error is less than 1 % of the radius.
constexpr int kChordsOfHalf = 12;

}  // namespace

std::vector<Eigen::Vector2d> outline_of(const Landmark& l) {
  if (!(l.width_m > 0.0)) return {};
  const Eigen::Vector2d along(std::cos(l.direction_rad), std::sin(l.direction_rad));
  const Eigen::Vector2d half = 0.5 * std::max(0.0, l.length_m - l.width_m) * along;
  const Eigen::Vector2d middle(l.x_m, l.y_m);
  // The half circles of a round landmark share their end points, which are drawn once.
  const int num_of_half = half.isZero() ? kChordsOfHalf : kChordsOfHalf + 1;
  std::vector<Eigen::Vector2d> border;
  for (const double end : {1.0, -1.0}) {
    for (int i = 0; i < num_of_half; ++i) {
      const double angle_rad =
          l.direction_rad + geometry::kPi * (static_cast<double>(i) / kChordsOfHalf - 0.5 * end);
      border.push_back(middle + end * half +
                       0.5 * l.width_m * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad)));
    }
  }
  return border;
}

}  // namespace orchard::mapping
