// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/plot_axes.hpp"

#include <algorithm>
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

PlotAxes PlotAxes::equal_scale(const PixelBox& box, AxisRange x, AxisRange y) {
  const double per_px = std::max({std::abs(x.to - x.from) / box.width(),
                                  std::abs(y.to - y.from) / box.height(), kMinRange / box.width()});
  return {box, widened(x, per_px * box.width()), widened(y, per_px * box.height())};
}

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

}  // namespace orchard::io
