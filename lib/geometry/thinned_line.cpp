// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/thinned_line.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"

namespace orchard::geometry {
namespace {

/// Range of directions from the last kept point, relative to the direction of the first point after
/// it.
struct Cone {
  bool is_open = false;  ///< not narrowed by any point yet
  double middle_rad = 0.0;
  double least_rad = -kPi, most_rad = kPi;  ///< relative to middle_rad
  double reach_m = 0.0;                     ///< distance of the farthest point
};

double relative(double angle_rad, double to_rad) {
  return std::remainder(angle_rad - to_rad, 2.0 * kPi);
}

}  // namespace

std::vector<Eigen::Vector2d> thinned_line(const std::vector<Eigen::Vector2d>& line,
                                          double tolerance_m) {
  if (line.size() < 3) return line;
  std::vector<Eigen::Vector2d> kept{line.front()};
  Cone cone;
  for (std::size_t k = 1; k < line.size(); ++k) {
    const auto allows = [&](const Eigen::Vector2d& p) {
      const Eigen::Vector2d step = p - kept.back();
      const double distance_m = step.norm();
      // A line that turns back stays inside the cone but does not reach as far.
      if (distance_m + tolerance_m < cone.reach_m) return false;
      if (distance_m <= tolerance_m) return true;
      const double angle_rad = std::atan2(step.y(), step.x());
      if (cone.is_open) {
        const double off_rad = relative(angle_rad, cone.middle_rad);
        if (off_rad < cone.least_rad || off_rad > cone.most_rad) return false;
      }
      return true;
    };
    if (!allows(line[k])) {
      kept.push_back(line[k - 1]);
      cone = Cone{};
    }
    const Eigen::Vector2d step = line[k] - kept.back();
    const double distance_m = step.norm();
    cone.reach_m = std::max(cone.reach_m, distance_m);
    if (distance_m <= tolerance_m) continue;
    const double angle_rad = std::atan2(step.y(), step.x());
    if (!cone.is_open) {
      cone.is_open = true;
      cone.middle_rad = angle_rad;
    }
    const double off_rad = relative(angle_rad, cone.middle_rad);
    const double half_rad = std::asin(std::min(1.0, tolerance_m / distance_m));
    cone.least_rad = std::max(cone.least_rad, off_rad - half_rad);
    cone.most_rad = std::min(cone.most_rad, off_rad + half_rad);
  }
  kept.push_back(line.back());
  return kept;
}

}  // namespace orchard::geometry
