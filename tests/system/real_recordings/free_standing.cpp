// SPDX-License-Identifier: BSD-3-Clause
#include "system/real_recordings/free_standing.hpp"

#include <cmath>
#include <cstddef>

namespace orchard::test {
namespace {

constexpr double kJump_m = 0.25;
constexpr double kNear_m = 0.9, kFar_m = 7.0;
constexpr double kBearingMax_rad = 2.44;  // beams straight behind see the robot itself
constexpr double kWidthMin_m = 0.08, kWidthMax_m = 0.40;

}  // namespace

std::vector<Eigen::Vector2d> free_standing(const laser::Scan& scan) {
  std::vector<Eigen::Vector2d> points;
  const std::vector<float>& r = scan.ranges_m;
  for (std::size_t first = 0, last = 0; first < r.size(); first = last + 1) {
    last = first;
    double sum_m = r[first];
    while (last + 1 < r.size() && r[last + 1] > 0.0f && std::abs(r[last + 1] - r[last]) < kJump_m) {
      sum_m += r[++last];
    }
    if (first == 0 || first == last || last + 1 == r.size()) continue;
    const double num_beams = static_cast<double>(last - first + 1);
    const double mean_m = sum_m / num_beams;
    const double width_m = mean_m * num_beams * scan.bearing_step_rad;
    const double bearing_rad = scan.bearing_rad(0.5 * static_cast<double>(first + last));
    const auto is_behind = [&](float range_m) { return range_m == 0.0f || range_m > mean_m; };
    if (!is_behind(r[first - 1]) || !is_behind(r[last + 1])) continue;
    if (mean_m <= kNear_m || mean_m >= kFar_m || std::abs(bearing_rad) >= kBearingMax_rad) continue;
    if (width_m <= kWidthMin_m || width_m >= kWidthMax_m) continue;
    const double centre_m = mean_m + 0.5 * width_m;
    points.emplace_back(centre_m * std::cos(bearing_rad), centre_m * std::sin(bearing_rad));
  }
  return points;
}

}  // namespace orchard::test
