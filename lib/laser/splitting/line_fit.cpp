// SPDX-License-Identifier: BSD-3-Clause
#include "laser/splitting/line_fit.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::laser {

double line_chi2(const Arc& arc, double range_sd_m) {
  // A line is 1 / range = a cos + b sin; sd(1 / range) = sd(range) / range^2.
  double cc = 0.0, cs = 0.0, ss = 0.0, cy = 0.0, sy = 0.0, yy = 0.0;
  for (std::size_t i = 0; i < arc.ranges_m.size(); ++i) {
    const double weight = arc.ranges_m[i] * arc.ranges_m[i] / range_sd_m;
    const double c = weight * arc.cosines[i];
    const double s = weight * arc.sines[i];
    const double y = arc.ranges_m[i] / range_sd_m;
    cc += c * c;
    cs += c * s;
    ss += s * s;
    cy += c * y;
    sy += s * y;
    yy += y * y;
  }
  const double determinant = cc * ss - cs * cs;
  if (!(determinant > 0.0)) return 0.0;
  const double a = (cy * ss - sy * cs) / determinant, b = (sy * cc - cy * cs) / determinant;
  return std::max(0.0, yy - a * cy - b * sy);
}

}  // namespace orchard::laser
