// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "io/figure/canvas.hpp"

namespace orchard::io {

inline constexpr double kAxisTextPx = 14.0;
inline constexpr Colour kBlack{30, 30, 30};

/// From the value at the left (or lower) end of an axis to that at its right (or upper) end.
struct AxisRange {
  double from = 0.0, to = 1.0;
};

/// A rectangle of a figure with axes of its own.
class PlotAxes {
 public:
  /// The box shows the ranges as they are; an empty range is widened to a thousandth.
  PlotAxes(const PixelBox& box, AxisRange x, AxisRange y);

  /// A unit is as long upward as to the right: one of the ranges is widened for it.
  static PlotAxes equal_scale(const PixelBox& box, AxisRange x, AxisRange y);

  PixelPoint at(double x, double y) const;
  const PixelBox& box() const { return box_; }

  /// Grid, ticks, frame and names of the axes. The numbers are right of box.x0 - kLeftPx.
  void draw(const std::string& x_name, const std::string& y_name, Canvas& canvas) const;

  /// A line through points, those nearer than a pixel to the one before left out.
  void draw_line(const std::vector<PixelPoint>& values, Colour colour, double width,
                 Canvas& canvas) const;

  /// The room that numbers and names take beside the box.
  static constexpr double kLeftPx = 70.0, kRightPx = 30.0, kBottomPx = 52.0;

 private:
  PixelBox box_;
  AxisRange x_, y_;
};

/// 1, 2 or 5 times a power of ten, at least `least`.
double round_step(double least);

/// As many decimals as multiples of the step have.
int decimals_of(double step);

}  // namespace orchard::io
