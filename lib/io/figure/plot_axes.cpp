// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/plot_axes.hpp"

#include <algorithm>
#include <cmath>

#include "io/fixed_text.hpp"

namespace orchard::io {
namespace {

constexpr double kMinTickPx = 60.0;
constexpr double kTextPx = 14.0;
constexpr Colour kBlack{30, 30, 30}, kGrid{228, 228, 228};

/// 1, 2 or 5 times a power of ten.
double tick_step(double range, double length_px) {
  const double least = kMinTickPx * range / length_px;
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= least) return factor * power;
  }
  return 10.0 * power;
}

int decimals_of(double step) {
  return std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
}

void widen(double& low, double& high, double share, double least) {
  const double more = std::max(share * (high - low), 0.5 * (least - (high - low)));
  low -= more;
  high += more;
}

}  // namespace

PlotAxes::PlotAxes(PixelPoint top_left, double width_px, double height_px, double x_min,
                   double x_max, double y_min, double y_max, bool equal_scale)
    : top_left_(top_left),
      width_px_(width_px),
      height_px_(height_px),
      x0_(x_min),
      x1_(x_max),
      y0_(y_min),
      y1_(y_max) {
  widen(x0_, x1_, equal_scale ? 0.04 : 0.0, 1e-3);
  widen(y0_, y1_, equal_scale ? 0.04 : 0.0, 1e-3);
  if (!equal_scale) return;
  const double per_px = std::max((x1_ - x0_) / width_px_, (y1_ - y0_) / height_px_);
  widen(x0_, x1_, 0.0, per_px * width_px_);
  widen(y0_, y1_, 0.0, per_px * height_px_);
}

PixelPoint PlotAxes::at(double x, double y) const {
  return {top_left_.x + (x - x0_) / (x1_ - x0_) * width_px_,
          top_left_.y + (y1_ - y) / (y1_ - y0_) * height_px_};
}

void PlotAxes::draw(const std::string& x_name, const std::string& y_name, Canvas& canvas) const {
  const double left = top_left_.x, right = left + width_px_;
  const double top = top_left_.y, bottom = top + height_px_;
  const double x_step = tick_step(x1_ - x0_, width_px_);
  for (double k = std::ceil(x0_ / x_step); k * x_step <= x1_; k += 1.0) {
    const double x = at(k * x_step, 0.0).x;
    canvas.line({x, top}, {x, bottom}, kGrid, 1.0);
    canvas.line({x, bottom}, {x, bottom + 5.0}, kBlack, 1.0);
    canvas.text({x, bottom + 20.0}, fixed_text(k * x_step, decimals_of(x_step)), kTextPx, kBlack,
                TextAnchor::kMiddle);
  }
  const double y_step = tick_step(y1_ - y0_, height_px_);
  for (double k = std::ceil(y0_ / y_step); k * y_step <= y1_; k += 1.0) {
    const double y = at(0.0, k * y_step).y;
    canvas.line({left, y}, {right, y}, kGrid, 1.0);
    canvas.line({left - 5.0, y}, {left, y}, kBlack, 1.0);
    canvas.text({left - 9.0, y + 5.0}, fixed_text(k * y_step, decimals_of(y_step)), kTextPx, kBlack,
                TextAnchor::kEnd);
  }
  canvas.polyline({{left, top}, {right, top}, {right, bottom}, {left, bottom}, {left, top}}, kBlack,
                  1.0);
  canvas.text({0.5 * (left + right), bottom + 42.0}, x_name, kTextPx, kBlack, TextAnchor::kMiddle);
  canvas.text({left, top - 10.0}, y_name, kTextPx, kBlack, TextAnchor::kStart);
}

void PlotAxes::draw_line(const std::vector<PixelPoint>& values, Colour colour, double width,
                         Canvas& canvas) const {
  constexpr double kLeastStepPx = 1.0;
  std::vector<PixelPoint> points;
  for (const PixelPoint& value : values) {
    const PixelPoint p = at(value.x, value.y);
    if (!points.empty() &&
        std::hypot(p.x - points.back().x, p.y - points.back().y) < kLeastStepPx) {
      continue;
    }
    points.push_back(p);
  }
  if (points.size() > 1) canvas.polyline(points, colour, width);
}

}  // namespace orchard::io
