// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

namespace orchard::vision {

/// An edge pixel of a window, from its top left corner.
struct EdgePoint {
  int x_px = 0;
  int y_px = 0;
};

/// A near-vertical straight line x = x_mean + tan(tilt) (y - y_mean).
struct Line {
  double x_mean_px = 0.0;
  double y_mean_px = 0.0;
  double tilt_rad = 0.0;      ///< from the vertical
  double straightness = 0.0;  ///< 1 - lambda_min / lambda_max, or R^2: in [0, 1]

  double x_at(double y_px) const;
};

/// Total least squares: the principal axis of the points. None for fewer than two distinct points.
std::optional<Line> fit_total_least_squares(const std::vector<EdgePoint>& points);

/// Linear regression of x on y; straightness is R^2, which is 0 for a perfectly vertical line.
/// None when all points share a row. Source: Shalal et al. 2013, section 4.2 (the paper's words).
std::optional<Line> fit_regression(const std::vector<EdgePoint>& points);

/// The points within `inlier_px` of the line, not steeper than max_tilt_rad, that has most of them;
/// among equals the one nearest to `expected_x_px` at the middle row. In the order given.
std::vector<EdgePoint> points_of_best_line(const std::vector<EdgePoint>& points, int width_px,
                                           int height_px, double expected_x_px, double inlier_px,
                                           double max_tilt_rad);

}  // namespace orchard::vision
