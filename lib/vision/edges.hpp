// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "vision/pixel_block.hpp"
#include "vision/vision_config.hpp"

namespace orchard::vision {

/// Detects the edge pixels of a grey image: 255 on an edge, 0 elsewhere; rows top-down, no padding.
///
/// Gradients are Sobel 3 x 3 with replicated borders; their magnitude is |dx| + |dy|. The
/// thresholds `low` <= `high` of the magnitude are rounded down. The result equals cv::Canny(grey,
/// edges, low, high) in less than a third of its time on the detector's small images. `grey` has
/// width_px x height_px bytes.
/// Source: Canny 1986, "A computational approach to edge detection".
std::vector<std::uint8_t> canny(const std::uint8_t* grey, int width_px, int height_px, double low,
                                double high);

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

/// A straight edge found in a window.
struct EdgeLine {
  bool found = false;
  double x_px = 0.0;      ///< image column at the window's middle row
  double tilt_rad = 0.0;  ///< from the image's vertical; positive if x increases downwards
  double roc = 0.0;       ///< roc of this edge, 0 unless found
};

/// Canny's edge pixels of a part of an image, one byte per pixel: 0 = no edge.
struct EdgeMap {
  PixelRect area;
  std::vector<std::uint8_t> edges;  ///< area.width_px x area.height_px, rows top-down
};

/// Computes the edge map of a block or of an area in it: grey as the weighted sum of the colours,
/// median filter, Canny. One pass for all windows is cheaper than one per window. Throws
/// std::invalid_argument when the area is empty or does not lie inside the block.
/// Source: Shalal et al. 2013, section 4.2 and figure 13.
EdgeMap edge_map(const PixelBlock& pixels, const EdgeConfig& config);
EdgeMap edge_map(const PixelBlock& pixels, const PixelRect& area, const EdgeConfig& config);

/// The area to decode for a window: with the padding that the filters need to give the same result
/// at the window's border as in the whole image.
PixelRect edge_reading_area(const PixelRect& window, const PixelRect& picture);

/// Finds a trunk's edge in a window: the straight line with edge pixels in most rows; among equals
/// the one nearest to `expected_x_px`.
///
/// roc is (1 - lambda_min / lambda_max) of the line's edge pixels times the fraction of the
/// window's rows that have one, or R^2 with LineFit::kRegression. Not found with fewer than
/// config.min_points pixels or with a tilt above config.max_tilt_deg. Throws std::invalid_argument
/// when the window does not lie inside the map.
/// Source: Shalal et al. 2013, section 4.2 and figure 9.
EdgeLine find_edge(const EdgeMap& map, const PixelRect& window, double expected_x_px,
                   const EdgeConfig& config);

/// roc_parallel: 1 for parallel edges, falling to 0 at 10 degrees between them;
/// 0 unless both were found.
double parallel_confidence(const EdgeLine& left, const EdgeLine& right);

}  // namespace orchard::vision
