// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "io/figure/canvas.hpp"

namespace orchard::io {

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

}  // namespace orchard::io
