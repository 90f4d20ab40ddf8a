// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/legend.hpp"

#include "io/figure/plot_axes.hpp"

namespace orchard::io {
namespace {

constexpr double kRowPx = 22.0;
constexpr double kSignPx = 20.0;
constexpr double kGapPx = 5.0;    // from a sign to its name
constexpr double kNextPx = 18.0;  // from a name to the next sign

}  // namespace

LegendItem line_item(const std::string& name, Colour colour, bool is_dashed) {
  return {name, [colour, is_dashed](PixelPoint centre, Canvas& canvas) {
            canvas.polyline({{centre.x - 9.0, centre.y}, {centre.x + 9.0, centre.y}}, colour, 2.0,
                            is_dashed);
          }};
}

Legend::Legend(std::vector<LegendItem> items, double width_px) : items_(std::move(items)) {
  PixelPoint at{0.0, 0.0};
  for (const LegendItem& item : items_) {
    const double item_px = kSignPx + kGapPx + text_width_px(item.name, kAxisTextPx);
    if (at.x > 0.0 && at.x + item_px > width_px) at = {0.0, at.y + kRowPx};
    places_.push_back({at.x + 0.5 * kSignPx, at.y + 0.5 * kRowPx});
    at.x += item_px + kNextPx;
  }
}

double Legend::height_px() const { return places_.empty() ? 0.0 : places_.back().y + 0.5 * kRowPx; }

void Legend::draw(PixelPoint top_left, Canvas& canvas) const {
  for (std::size_t i = 0; i < items_.size(); ++i) {
    const PixelPoint sign{top_left.x + places_[i].x, top_left.y + places_[i].y};
    items_[i].draw_sign(sign, canvas);
    canvas.text({sign.x + 0.5 * kSignPx + kGapPx, sign.y + 5.0}, items_[i].name,
                {kAxisTextPx, kBlack});
  }
}

}  // namespace orchard::io
