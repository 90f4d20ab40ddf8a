// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

namespace orchard::vision {

/// An edge pixel, relative to the window's top left corner.
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

/// Fits a line by total least squares: the principal axis of the points. None for fewer than two
/// distinct points.
std::optional<Line> fit_total_least_squares(const std::vector<EdgePoint>& points);

/// Fits a line by linear regression of x on y. straightness is R^2, which is 0 for a perfectly
/// vertical line. None when all points are in one row. Source: Shalal et al. 2013, section 4.2,
/// taken literally.
std::optional<Line> fit_regression(const std::vector<EdgePoint>& points);

/// Finds the line with most points within `inlier_px` and a tilt of at most `max_tilt_rad`; among
/// equals the one nearest to `expected_x_px` at the middle row. Returns its points, in order.
std::vector<EdgePoint> points_of_best_line(const std::vector<EdgePoint>& points, int width_px,
                                           int height_px, double expected_x_px, double inlier_px,
                                           double max_tilt_rad);

}  // namespace orchard::vision
