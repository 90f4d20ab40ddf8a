// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <vector>

namespace orchard::evaluation {

/// One line of a plot.
struct PlotSeries {
  std::string name;  ///< in the legend; empty = none
  std::vector<std::array<double, 2>> points;
  bool has_line = true;
  bool has_marks = false;
  bool is_reference = false;  ///< thin, grey and dashed
};

/// What a plot shows.
struct Plot {
  std::string title, x_label, y_label;
  double x_min = 0.0, x_max = 1.0, y_min = 0.0, y_max = 1.0;
  std::vector<PlotSeries> series;
};

/// An SVG element for inside an HTML page: axes with five ticks, lines, a legend. Points outside
/// the axes are drawn on their border; non-finite ones are left out.
std::string svg_plot(const Plot& plot);

/// Text as HTML and SVG may hold it.
std::string escaped(const std::string& text);

}  // namespace orchard::evaluation
