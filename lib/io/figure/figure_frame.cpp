// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/figure_frame.hpp"

#include <algorithm>
#include <cmath>

#include "io/fixed_text.hpp"

namespace orchard::io {
namespace {

constexpr double kPlotWidthPx = 1100.0;
constexpr double kPlotHeightPx = 800.0;
constexpr double kPlotMinPx = 220.0;
constexpr double kLeftPx = 70.0, kRightPx = 30.0, kTopPx = 50.0, kBottomPx = 60.0;
constexpr double kMinTickPx = 60.0;

constexpr Colour kBlack{30, 30, 30}, kGrid{228, 228, 228};

/// 1, 2 or 5 times a power of ten.
double tick_step_m(double px_per_m) {
  const double least_m = kMinTickPx / px_per_m;
  const double power = std::pow(10.0, std::floor(std::log10(least_m)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= least_m) return factor * power;
  }
  return 10.0 * power;
}

}  // namespace

FigureFrame::FigureFrame(const std::vector<Eigen::Vector2d>& points_map) {
  for (const Eigen::Vector2d& p : points_map) include(p.x(), p.y());
  if (x0_ > x1_) x0_ = y0_ = -1.0, x1_ = y1_ = 1.0;
  const double margin_m = std::max(0.3, 0.04 * std::max(x1_ - x0_, y1_ - y0_));
  x0_ -= margin_m, y0_ -= margin_m, x1_ += margin_m, y1_ += margin_m;
  px_per_m_ = std::min(kPlotWidthPx / (x1_ - x0_), kPlotHeightPx / (y1_ - y0_));
  widen(x0_, x1_);
  widen(y0_, y1_);
}

void FigureFrame::include(double x, double y) {
  if (!std::isfinite(x) || !std::isfinite(y)) return;
  x0_ = std::min(x0_, x), x1_ = std::max(x1_, x);
  y0_ = std::min(y0_, y), y1_ = std::max(y1_, y);
}

/// A map of one row alone would be a strip too thin for axes and numbers.
void FigureFrame::widen(double& lo, double& hi) const {
  const double missing_m = kPlotMinPx / px_per_m_ - (hi - lo);
  if (missing_m > 0.0) lo -= 0.5 * missing_m, hi += 0.5 * missing_m;
}

PixelPoint FigureFrame::at(double x_m, double y_m) const {
  return {kLeftPx + (x_m - x0_) * px_per_m_, kTopPx + (y1_ - y_m) * px_per_m_};
}

PixelBox FigureFrame::plot() const {
  const PixelPoint low = at(x0_, y0_), high = at(x1_, y1_);
  return {low.x, high.y, high.x, low.y};
}

int FigureFrame::width_px() const {
  return std::max(560, static_cast<int>(std::ceil(plot().x1 + kRightPx)));
}

int FigureFrame::height_px() const { return static_cast<int>(std::ceil(plot().y1 + kBottomPx)); }

PixelPoint FigureFrame::legend() const { return {kLeftPx + 10.0, 22.0}; }

void FigureFrame::draw_axes(Canvas& canvas) const {
  const PixelBox plot = this->plot();
  const double step = tick_step_m(px_per_m_);
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  for (double k = std::ceil(x0_ / step); k * step <= x1_; k += 1.0) {
    const double x = at(k * step, 0.0).x;
    canvas.line({x, plot.y0}, {x, plot.y1}, kGrid, 1.0);
    canvas.line({x, plot.y1}, {x, plot.y1 + 5.0}, kBlack, 1.0);
    canvas.text({x, plot.y1 + 20.0}, fixed_text(k * step, decimals), kAxisTextPx, kBlack,
                TextAnchor::kMiddle);
  }
  for (double k = std::ceil(y0_ / step); k * step <= y1_; k += 1.0) {
    const double y = at(0.0, k * step).y;
    canvas.line({plot.x0, y}, {plot.x1, y}, kGrid, 1.0);
    canvas.line({plot.x0 - 5.0, y}, {plot.x0, y}, kBlack, 1.0);
    canvas.text({plot.x0 - 9.0, y + 5.0}, fixed_text(k * step, decimals), kAxisTextPx, kBlack,
                TextAnchor::kEnd);
  }
  canvas.polyline({{plot.x0, plot.y0},
                   {plot.x1, plot.y0},
                   {plot.x1, plot.y1},
                   {plot.x0, plot.y1},
                   {plot.x0, plot.y0}},
                  kBlack, 1.0);
  canvas.text({0.5 * (plot.x0 + plot.x1), plot.y1 + 44.0}, "x (m)", kAxisTextPx, kBlack,
              TextAnchor::kMiddle);
  canvas.text({plot.x0 - 9.0, plot.y0 - 18.0}, "y (m)", kAxisTextPx, kBlack, TextAnchor::kEnd);
}

void FigureFrame::draw_path(const std::vector<pose::PoseEstimate>& path, Canvas& canvas) const {
  constexpr double kLeastStepPx = 0.75;
  std::vector<PixelPoint> points;
  for (const pose::PoseEstimate& pose : path) {
    const PixelPoint p = at(pose.x_m, pose.y_m);
    if (!points.empty() &&
        std::hypot(p.x - points.back().x, p.y - points.back().y) < kLeastStepPx) {
      continue;
    }
    points.push_back(p);
  }
  if (points.size() > 1) canvas.polyline(points, kPathColour, 1.5);
  for (const PixelPoint& p : points) {
    if (points.size() <= 50)
      canvas.circle(p, 2.0, kPathColour, kPathColour);  // where a stepped robot stood
  }
}

}  // namespace orchard::io
