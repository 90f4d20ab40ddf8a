// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "detection/detection.hpp"
#include "detection/trunk_view.hpp"
#include "io/figure/canvas.hpp"
#include "vision/edges.hpp"
#include "vision/pixel_block.hpp"

namespace orchard::io {

/// A scan point in the picture; pixel centres are whole numbers.
struct OverlayPoint {
  double x_px = 0.0;
  double y_px = 0.0;
  double range_m = 0.0;
};

/// A candidate with its windows, the edges found in them, and what was made of it.
struct OverlayCandidate {
  detection::TrunkView view;
  vision::EdgeLine left;
  vision::EdgeLine right;
  bool edges_judged = false;  ///< the detector looks at edges only of what has a trunk's colour
  detection::Detection detection;
};

/// A picture and everything that is drawn on it.
struct OverlayContent {
  vision::PixelBlock picture;  ///< all of it
  std::vector<OverlayPoint> points;
  std::vector<OverlayCandidate> candidates;
  std::string title;  ///< ASCII
};

/// Draws the picture, enlarged so that text is readable, with scan points coloured by range (red
/// near, blue far), each candidate's colour window (white) and edge windows (grey), the columns
/// where the laser expects its edges (ticks), the lines that were found (cyan; dark where the
/// detector did not look at them), and a table of its confidences below. Returns the file.
std::string overlay_figure(const OverlayContent& content, FigureFormat format);

}  // namespace orchard::io
