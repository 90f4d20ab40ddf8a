// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <vector>

namespace orchard::evaluation {

/// One line of a plot.
struct PlotSeries {
  std::string name;  ///< name in the legend; empty: none
  std::vector<std::array<double, 2>> points;
  bool has_line = true;
  bool has_marks = false;
  bool is_reference = false;  ///< thin, grey and dashed
};

/// Content of a plot. Points outside the ranges are drawn on the border; points that are not finite
/// are left out.
struct Plot {
  std::string title, x_label, y_label;
  double x_min = 0.0, x_max = 1.0, y_min = 0.0, y_max = 1.0;
  std::vector<PlotSeries> series;
};

}  // namespace orchard::evaluation
