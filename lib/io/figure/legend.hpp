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

/// A short line as a sign.
LegendItem line_item(const std::string& name, Colour colour, bool is_dashed = false);

/// Signs with their names, in as many rows as the width asks for.
class Legend {
 public:
  Legend(std::vector<LegendItem> items, double width_px);

  double height_px() const;
  void draw(PixelPoint top_left, Canvas& canvas) const;

 private:
  std::vector<LegendItem> items_;
  std::vector<PixelPoint> places_;  ///< of the signs' centres, from the top left corner
};

}  // namespace orchard::io
