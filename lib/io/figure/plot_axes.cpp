// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/plot_axes.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "text/number_text.hpp"

namespace orchard::io {
namespace {

constexpr double kMinTickXPx = 60.0, kMinTickYPx = 40.0;
constexpr double kTick_px = 5.0;
constexpr double kMinStepPx = 1.0;  // between two points of a line
constexpr double kMinRange = 1e-3;
constexpr Colour kGrid{228, 228, 228};

/// The centre of a pixel, where a line of one pixel width is sharp.
double sharp(double px) { return std::floor(px) + 0.5; }

AxisRange widened(AxisRange range, double least) {
  const double missing = least - std::abs(range.to - range.from);
  if (!(missing > 0.0)) return range;
  const double half = range.to < range.from ? -0.5 * missing : 0.5 * missing;
  return {range.from - half, range.to + half};
}

/// Values of an axis at which it has ticks.
std::vector<double> ticks(AxisRange range, double step) {
  const double low = std::min(range.from, range.to), high = std::max(range.from, range.to);
  std::vector<double> values;
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k += 1.0) {
    values.push_back(k * step);
  }
  return values;
}

double step_of(AxisRange range, double length_px, double least_px) {
  return round_step(least_px * std::abs(range.to - range.from) / length_px);
}

constexpr double kRowPx = 22.0;
constexpr double kSignPx = 20.0;
constexpr double kGapPx = 5.0;    // from a sign to its name
constexpr double kNextPx = 18.0;  // from a name to the next sign

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

double round_step(double least) {
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= least) return factor * power;
  }
  return 10.0 * power;
}

int decimals_of(double step) {
  return std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
}

PlotAxes::PlotAxes(const PixelBox& box, AxisRange x, AxisRange y)
    : box_(box), x_(widened(x, kMinRange)), y_(widened(y, kMinRange)) {}

PixelPoint PlotAxes::at(double x, double y) const {
  return {box_.x0 + (x - x_.from) / (x_.to - x_.from) * box_.width(),
          box_.y1 - (y - y_.from) / (y_.to - y_.from) * box_.height()};
}

void PlotAxes::draw(const std::string& x_name, const std::string& y_name, Canvas& canvas) const {
  const PixelBox box{sharp(box_.x0), sharp(box_.y0), sharp(box_.x1), sharp(box_.y1)};
  const double x_step = step_of(x_, box_.width(), kMinTickXPx),
               y_step = step_of(y_, box_.height(), kMinTickYPx);
  for (const double value : ticks(x_, x_step)) {
    const double x = sharp(at(value, y_.from).x);
    canvas.line({x, box.y0}, {x, box.y1}, kGrid, 1.0);
    canvas.line({x, box.y1}, {x, box.y1 + kTick_px}, kBlack, 1.0);
    canvas.text({x, box.y1 + 20.0}, fixed_text(value, decimals_of(x_step)),
                {kAxisTextPx, kBlack, TextAnchor::kMiddle});
  }
  for (const double value : ticks(y_, y_step)) {
    const double y = sharp(at(x_.from, value).y);
    canvas.line({box.x0, y}, {box.x1, y}, kGrid, 1.0);
    canvas.line({box.x0 - kTick_px, y}, {box.x0, y}, kBlack, 1.0);
    canvas.text({box.x0 - 9.0, y + 5.0}, fixed_text(value, decimals_of(y_step)),
                {kAxisTextPx, kBlack, TextAnchor::kEnd});
  }
  canvas.rectangle(box, {}, kBlack);
  canvas.text({0.5 * (box.x0 + box.x1), box.y1 + 42.0}, x_name,
              {kAxisTextPx, kBlack, TextAnchor::kMiddle});
  TextStyle upward{kAxisTextPx, kBlack, TextAnchor::kMiddle};
  upward.is_upward = true;
  canvas.text({box.x0 - kLeftPx + 16.0, 0.5 * (box.y0 + box.y1)}, y_name, upward);
}

void PlotAxes::draw_line(const std::vector<PixelPoint>& values, Colour colour, double width,
                         Canvas& canvas) const {
  std::vector<PixelPoint> points;
  for (const PixelPoint& value : values) {
    const PixelPoint p = at(value.x, value.y);
    if (!points.empty() && std::hypot(p.x - points.back().x, p.y - points.back().y) < kMinStepPx) {
      continue;
    }
    points.push_back(p);
  }
  if (points.size() > 1) canvas.polyline(points, colour, width);
}

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
  canvas->text({x, y}, text, {text_px, colour, TextAnchor::kStart, false, false, kWhite});
  return true;
}

void draw_row_name(PixelPoint first, PixelPoint other, const std::string& name, Colour colour,
                   LabelPlacement& placement, Canvas& canvas) {
  constexpr double kOut_px = 14.0;
  const double dx = first.x - other.x, dy = first.y - other.y;
  const double fraction = kOut_px / std::max(1e-9, std::hypot(dx, dy));
  draw_label({first.x + fraction * dx, first.y + fraction * dy}, 0.0, name, kAxisTextPx, colour,
             placement, &canvas);
}

void draw_numbers(const std::vector<NumberLabel>& labels, double text_px,
                  const LabelPlacement& placement, Canvas& canvas) {
  constexpr std::array<std::int32_t, 12> kSteps{1,   2,   5,   10,   20,   50,
                                                100, 200, 500, 1000, 2000, 5000};
  constexpr double kPlacedFraction = 0.8;
  const auto draw_every = [&](std::int32_t step, Canvas* drawn_on) {
    LabelPlacement free = placement;
    int num_wanted = 0, num_placed = 0;
    for (const NumberLabel& label : labels) {
      if (label.number % step != 0) continue;
      ++num_wanted;
      num_placed += draw_label(label.sign, label.radius_px, label.text, text_px, label.colour, free,
                               drawn_on);
    }
    return num_placed >= kPlacedFraction * num_wanted;
  };
  std::size_t i = 0;
  while (i + 1 < kSteps.size() && !draw_every(kSteps[i], nullptr)) ++i;
  draw_every(kSteps[i], &canvas);
}

}  // namespace orchard::io
