// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vision/tuning.hpp"

namespace orchard::vision {

/// Windows around projected laser points. Section `detector.window`. Sizes are in metres on the
/// trunk, so sizes in pixels are inversely proportional to range (Shalal et al. 2013, section 4.2).
struct WindowConfig {
  double colour_width_m = 0.06;
  double colour_height_m = 0.20;
  double edge_width_m = 0.06;
  double edge_height_m = 0.20;
};

template <class Visitor>
void describe(Visitor& v, WindowConfig& c) {
  v.expert().number("colour_width_m", c.colour_width_m, 0.005, 2, "m",
                    "width of the colour window, on the trunk");
  v.expert().number("colour_height_m", c.colour_height_m, 0.005, 3, "m",
                    "height of the colour window, on the trunk");
  v.expert().number("edge_width_m", c.edge_width_m, 0.005, 2, "m",
                    "width of the edge window, across the edge");
  v.expert().number("edge_height_m", c.edge_height_m, 0.005, 3, "m",
                    "height of the edge window, along the edge");
}

/// The colour rule of the paper's figure 8. Section `detector.colour`.
struct ColourConfig {
  double hue_min_deg = 17.6;
  double hue_max_deg = 44.6;
  /// derived: bins of the histogram whose peak is the dominant hue, of 10 degrees: half of the
  /// narrowest interval of bark.
  static constexpr int kHueBins = 36;
};

template <class Visitor>
void describe(Visitor& v, ColourConfig& c) {
  v.number("hue_min_deg", c.hue_min_deg, 0, 360, "deg",
           "lower end of the hue of trunks; above hue_max_deg the interval wraps through red; from "
           "`orchard calibrate trunks`");
  v.number("hue_max_deg", c.hue_max_deg, 0, 360, "deg", "upper end of the hue of trunks");
}

enum class LineFit {
  kTotalMinSquares,  ///< search for the best line, then total least squares; any direction
  kRegression,       ///< linear regression of x on y with R^2, as the paper is worded
};

/// The edge rule of the paper's figure 9. Section `detector.edges`.
struct EdgeConfig {
  LineFit fit = LineFit::kTotalMinSquares;
  double canny_low = 40;
  double canny_high = 100;
  static constexpr int kMedianSize_px = 3;  ///< derived: smallest odd window above one
  int min_points = 5;
  double max_tilt_deg = 20;
};

template <class Visitor>
void describe(Visitor& v, EdgeConfig& c) {
  v.expert().choice("fit", c.fit, {"total_least_squares", "regression"},
                    "method of fitting a line to an edge");
  v.expert().number("canny_low", c.canny_low, 1, 1000, "grey",
                    "lower threshold of the Canny detector");
  v.expert().number("canny_high", c.canny_high, 1, 1000, "grey",
                    "upper threshold of the Canny detector");
  v.expert().integer("min_points", c.min_points, 2, 1000, "px", "min edge pixels of a line");
  v.expert().number("max_tilt_deg", c.max_tilt_deg, 1, 90, "deg",
                    "max tilt of a trunk's edge from the vertical");
  v.check(c.canny_low < c.canny_high, "canny_low", "must be below canny_high");
}

}  // namespace orchard::vision
