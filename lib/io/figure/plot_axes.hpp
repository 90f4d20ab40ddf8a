// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "io/figure/canvas.hpp"

namespace orchard::io {

/// A rectangle of a figure with axes of its own.
class PlotAxes {
 public:
  /// Ranges are widened a little; `equal_scale` makes a metre as long up as to the right.
  PlotAxes(PixelPoint top_left, double width_px, double height_px, double x_min, double x_max,
           double y_min, double y_max, bool equal_scale);

  PixelPoint at(double x, double y) const;

  /// Grid, ticks, frame and names of the axes.
  void draw(const std::string& x_name, const std::string& y_name, Canvas& canvas) const;

  /// A line through points, those nearer than a pixel left out.
  void draw_line(const std::vector<PixelPoint>& values, Colour colour, double width,
                 Canvas& canvas) const;

 private:
  PixelPoint top_left_;
  double width_px_, height_px_;
  double x0_, x1_, y0_, y1_;
};

}  // namespace orchard::io
