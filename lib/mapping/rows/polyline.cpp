// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/polyline.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::mapping {

double length_m(const Line& line) {
  double sum_m = 0.0;
  for (std::size_t i = 1; i < line.size(); ++i) sum_m += (line[i] - line[i - 1]).norm();
  return sum_m;
}

std::vector<LinePoint> sample_line(const Line& line, double step_m) {
  std::vector<LinePoint> points;
  const double whole_m = length_m(line);
  if (line.size() < 2 || whole_m <= 0.0) return points;
  const int num = std::max(1, static_cast<int>(std::ceil(whole_m / step_m)));
  std::size_t segment = 1;
  double before_m = 0.0;
  for (int k = 0; k <= num; ++k) {
    const double s_m = whole_m * k / num;
    while (segment + 1 < line.size() &&
           before_m + (line[segment] - line[segment - 1]).norm() < s_m) {
      before_m += (line[segment] - line[segment - 1]).norm();
      ++segment;
    }
    const Eigen::Vector2d d = line[segment] - line[segment - 1];
    const double fraction =
        d.norm() > 0.0 ? std::clamp((s_m - before_m) / d.norm(), 0.0, 1.0) : 0.0;
    // Direction over several segments, so that single points out of line do not turn it.
    const std::size_t first = segment >= 2 ? segment - 2 : 0;
    const std::size_t last = std::min(segment + 1, line.size() - 1);
    points.push_back({line[segment - 1] + fraction * d, (line[last] - line[first]).normalized()});
  }
  return points;
}

}  // namespace orchard::mapping
