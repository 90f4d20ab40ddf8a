// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/figure/canvas.hpp"

namespace orchard::io {

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

/// Draws a text on white beside a sign if there is space for it and returns whether there was.
/// Without a canvas it only reserves the space.
bool draw_label(PixelPoint sign, double sign_radius_px, const std::string& text, double text_px,
                Colour colour, LabelPlacement& placement, Canvas* canvas);

}  // namespace orchard::io
