// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "vision/pixel_block.hpp"
#include "vision/vision_config.hpp"

namespace orchard::vision {

/// The straight edge of a window.
struct EdgeLine {
  bool found = false;
  double x_px = 0.0;      ///< picture column where it crosses the window's middle row
  double tilt_rad = 0.0;  ///< from the picture's vertical; positive leans right going down
  double roc = 0.0;       ///< roc of this edge, 0 unless found
};

/// Canny's edge pixels of a part of a picture, one byte per pixel: 0 = none.
struct EdgeMap {
  PixelRect area;
  std::vector<std::uint8_t> edges;  ///< area.width_px x area.height_px, rows top-down
};

/// Grey as the weighted sum of the colours, median filter, Canny, over all of a block or an area in
/// it: one pass for all windows costs a fraction of a pass for each. Throws std::invalid_argument
/// when the area is empty or does not lie inside the block.
/// Source: Shalal et al. 2013, section 4.2 and figure 13.
EdgeMap edge_map(const PixelBlock& pixels, const EdgeConfig& config);
EdgeMap edge_map(const PixelBlock& pixels, const PixelRect& area, const EdgeConfig& config);

/// What must be decoded for a window, so that the filters work up to its border as they would in
/// the whole picture.
PixelRect edge_reading_area(const PixelRect& window, const PixelRect& picture,
                            const EdgeConfig& config);

/// Looks for a trunk's edge in a window: the straight line that covers most rows, and among equals
/// the one nearest to `expected_x_px`.
///
/// roc is (1 - lambda_min / lambda_max) of the edge pixels on the line times the fraction of the
/// window's rows that have one, or R^2 with LineFit::kRegression. No line with fewer than
/// config.min_points pixels or with more tilt than config.max_tilt_deg. Throws
/// std::invalid_argument when the window does not lie inside the map.
/// Source: Shalal et al. 2013, section 4.2 and figure 9.
EdgeLine find_edge(const EdgeMap& map, const PixelRect& window, double expected_x_px,
                   const EdgeConfig& config);

/// roc_parallel: 1 for parallel edges, falling to 0 at 10 degrees between them;
/// 0 unless both were found.
double parallel_confidence(const EdgeLine& left, const EdgeLine& right);

}  // namespace orchard::vision
