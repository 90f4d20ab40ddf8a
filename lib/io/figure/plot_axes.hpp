// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "io/figure/canvas.hpp"

namespace orchard::io {

inline constexpr double kAxisTextPx = 14.0;
inline constexpr Colour kBlack{30, 30, 30};

/// Values at the left (or lower) and the right (or upper) end of an axis.
struct AxisRange {
  double from = 0.0, to = 1.0;
};

/// A rectangular plot area with axes.
class PlotAxes {
 public:
  /// Uses the ranges as given; an empty range is widened to a thousandth.
  PlotAxes(const PixelBox& box, AxisRange x, AxisRange y);

  /// Uses equal scales on both axes by widening one of the ranges.
  static PlotAxes equal_scale(const PixelBox& box, AxisRange x, AxisRange y);

  PixelPoint at(double x, double y) const;
  const PixelBox& box() const { return box_; }

  /// Draws grid, ticks, frame and axis names. The numbers are right of box.x0 - kLeftPx.
  void draw(const std::string& x_name, const std::string& y_name, Canvas& canvas) const;

  /// Draws a line through points; points closer than a pixel to the previous one are omitted.
  void draw_line(const std::vector<PixelPoint>& values, Colour colour, double width,
                 Canvas& canvas) const;

  /// Margins for numbers and names beside the box.
  static constexpr double kLeftPx = 70.0, kRightPx = 30.0, kBottomPx = 52.0;

 private:
  PixelBox box_;
  AxisRange x_, y_;
};

/// Smallest step of 1, 2 or 5 times a power of ten that is at least `least`.
double round_step(double least);

/// Number of decimals needed for multiples of the step.
int decimals_of(double step);

}  // namespace orchard::io
