// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
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

struct LegendItem {
  std::string name;
  std::function<void(PixelPoint centre, Canvas&)> draw_sign;  ///< at most 20 pixels wide and high
};

/// A legend item with a short line as its sign.
LegendItem line_item(const std::string& name, Colour colour, bool is_dashed = false);

/// Signs with their names, in as many rows as the width requires.
class Legend {
 public:
  Legend(std::vector<LegendItem> items, double width_px);

  double height_px() const;
  void draw(PixelPoint top_left, Canvas& canvas) const;

 private:
  std::vector<LegendItem> items_;
  std::vector<PixelPoint> places_;  ///< centres of the signs, relative to the top left corner
};

/// Places labels one after another without overlap.
class LabelPlacement {
 public:
  /// No label extends beyond `within`.
  explicit LabelPlacement(const PixelBox& within);

  void take(const PixelBox& box);

  /// Returns the centre of a free box of that size beside a sign: right, left, above, below, then
  /// the corners, then the same a little farther away. None when all are occupied.
  std::optional<PixelPoint> place(PixelPoint sign, double sign_radius, double width, double height);

 private:
  bool is_free(const PixelBox& box) const;

  PixelBox within_;
  int num_columns_, num_rows_;
  std::vector<bool> taken_;  ///< by cell, row by row
};

/// Draws a text with a white halo beside a sign if there is space for it and returns whether there
/// was. Without a canvas it only reserves the space.
bool draw_label(PixelPoint sign, double sign_radius_px, const std::string& text, double text_px,
                Colour colour, LabelPlacement& placement, Canvas* canvas);

/// Draws a row's name before its first sign, away from another one of the row.
void draw_row_name(PixelPoint first, PixelPoint other, const std::string& name, Colour colour,
                   LabelPlacement& placement, Canvas& canvas);

/// A number at a sign.
struct NumberLabel {
  PixelPoint sign;
  double radius_px = 0.0;
  std::int32_t number = 0;
  std::string text;
  Colour colour;
};

/// Draws the labels whose numbers are multiples of 1, 2, 5, 10 ...: the first step at which nearly
/// all find a free place.
void draw_numbers(const std::vector<NumberLabel>& labels, double text_px,
                  const LabelPlacement& placement, Canvas& canvas);

}  // namespace orchard::io
