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

/// A scan point projected into the image; pixel centres are at whole numbers.
struct OverlayPoint {
  double x_px = 0.0;
  double y_px = 0.0;
  double range_m = 0.0;
};

/// A candidate with its image windows, the edges found in them, and the detection.
struct OverlayCandidate {
  detection::TrunkView view;
  vision::EdgeLine left;
  vision::EdgeLine right;
  bool edges_judged = false;  ///< the detector evaluates edges only for candidates of trunk colour
  detection::Detection detection;
};

/// Content of an overlay figure.
struct OverlayContent {
  vision::PixelBlock picture;  ///< the complete image
  std::vector<OverlayPoint> points;
  std::vector<OverlayCandidate> candidates;
  std::string title;  ///< ASCII
};

/// Draws the image, enlarged so that text is readable, with scan points coloured by range (red
/// near, blue far), each candidate's colour window (white) and edge windows (grey), the columns
/// where the laser expects its edges (ticks), the detected lines (cyan; dark if the detector did
/// not evaluate them), and a table of the confidences below. Returns the file.
std::string overlay_figure(const OverlayContent& content, FigureFormat format);

}  // namespace orchard::io
