// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/label_placement.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace orchard::io {
namespace {

constexpr double kCellPx = 2.0;
constexpr double kCapHeight = 0.73;  // of the font, relative to the text size
constexpr std::array<double, 2> kGapsPx{3.0, 8.0};
constexpr std::array<std::array<double, 2>, 8> kSides{
    {{1, 0}, {-1, 0}, {0, -1}, {0, 1}, {1, -1}, {-1, -1}, {1, 1}, {-1, 1}}};

int num_cells(double length_px) {
  return std::clamp(static_cast<int>(std::ceil(length_px / kCellPx)), 1, 10000);
}

/// Index range of the cells touched: first, and one past the last.
std::array<int, 2> cells(double from, double to, int num) {
  const auto cell = [num](double value) {
    return static_cast<int>(std::clamp(value / kCellPx, 0.0, static_cast<double>(num)));
  };
  return {cell(std::floor(from)), std::min(num, cell(std::ceil(to)) + 1)};
}

}  // namespace

LabelPlacement::LabelPlacement(const PixelBox& within)
    : within_(within),
      num_columns_(num_cells(within.width())),
      num_rows_(num_cells(within.height())),
      taken_(static_cast<std::size_t>(num_columns_) * static_cast<std::size_t>(num_rows_)) {}

void LabelPlacement::take(const PixelBox& box) {
  if (!std::isfinite(box.x0 + box.x1 + box.y0 + box.y1)) return;
  const auto columns = cells(box.x0 - within_.x0, box.x1 - within_.x0, num_columns_);
  const auto rows = cells(box.y0 - within_.y0, box.y1 - within_.y0, num_rows_);
  for (int row = rows[0]; row < rows[1]; ++row) {
    for (int column = columns[0]; column < columns[1]; ++column) {
      taken_[static_cast<std::size_t>(row * num_columns_ + column)] = true;
    }
  }
}

bool LabelPlacement::is_free(const PixelBox& box) const {
  if (!(box.x0 >= within_.x0 && box.x1 <= within_.x1 && box.y0 >= within_.y0 &&
        box.y1 <= within_.y1)) {
    return false;
  }
  const auto columns = cells(box.x0 - within_.x0, box.x1 - within_.x0, num_columns_);
  const auto rows = cells(box.y0 - within_.y0, box.y1 - within_.y0, num_rows_);
  for (int row = rows[0]; row < rows[1]; ++row) {
    const auto begin = taken_.begin() + row * num_columns_;
    if (std::find(begin + columns[0], begin + columns[1], true) != begin + columns[1]) return false;
  }
  return true;
}

std::optional<PixelPoint> LabelPlacement::place(PixelPoint sign, double sign_radius, double width,
                                                double height) {
  for (const double gap_px : kGapsPx) {
    for (const auto& side : kSides) {
      const PixelPoint c{sign.x + side[0] * (sign_radius + gap_px + 0.5 * width),
                         sign.y + side[1] * (sign_radius + gap_px + 0.5 * height)};
      const PixelBox box{c.x - 0.5 * width, c.y - 0.5 * height, c.x + 0.5 * width,
                         c.y + 0.5 * height};
      if (!is_free(box)) continue;
      take(box);
      return c;
    }
  }
  return {};
}

bool draw_label(PixelPoint sign, double sign_radius_px, const std::string& text, double text_px,
                Colour colour, LabelPlacement& placement, Canvas* canvas) {
  const double width_px = text_width_px(text, text_px), height_px = kCapHeight * text_px;
  const auto centre = placement.place(sign, sign_radius_px, width_px, height_px);
  if (!centre) return false;
  if (canvas == nullptr) return true;
  const double x = centre->x - 0.5 * width_px, y = centre->y + 0.5 * height_px;
  canvas->rectangle({x - 1.0, y - height_px - 1.0, x + width_px + 1.0, y + 1.0}, kWhite, {});
  canvas->text({x, y}, text, {text_px, colour});
  return true;
}

}  // namespace orchard::io
