// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/map_frame.hpp"

#include <algorithm>
#include <cmath>

#include "text/number_text.hpp"

namespace orchard::io {
namespace {

constexpr double kPlotWidthPx = 1100.0, kPlotHeightPx = 800.0;  // at most
constexpr double kPlotMinPx = 220.0;  // a map of one row would be too thin a strip for axes
constexpr double kPageWidthMinPx = 420.0;
constexpr double kEdgePx = 14.0;    // from the page's edge to the legend, from there to the plot
constexpr double kMarginPx = 32.0;  // from the outermost point to the frame: room for a label
constexpr double kMarginMin_m = 0.3;
constexpr double kScaleBarPx = 150.0;  // at most
constexpr double kTickPx = 4.0;

}  // namespace

/// The part of the map that is drawn.
struct MapFrame::Extent {
  explicit Extent(const std::vector<Eigen::Vector2d>& points_map) {
    for (const Eigen::Vector2d& p : points_map) {
      if (!p.allFinite()) continue;
      x.from = std::min(x.from, p.x()), x.to = std::max(x.to, p.x());
      y.from = std::min(y.from, p.y()), y.to = std::max(y.to, p.y());
    }
    if (x.from > x.to) x = y = {-1.0, 1.0};
    const double width_m = x.to - x.from, height_m = y.to - y.from;
    // The margin is of pixels, or of metres where that is more.
    const double per_px = std::max({width_m / (kPlotWidthPx - 2.0 * kMarginPx),
                                    height_m / (kPlotHeightPx - 2.0 * kMarginPx), 1e-9});
    const double margin_m = std::max(kMarginMin_m, kMarginPx * per_px);
    px_per_m = std::min(kPlotWidthPx / (width_m + 2.0 * margin_m),
                        kPlotHeightPx / (height_m + 2.0 * margin_m));
    widen(margin_m, x);
    widen(margin_m, y);
  }
  void widen(double margin_m, AxisRange& range) const {
    const double more_m =
        std::max(margin_m, 0.5 * (kPlotMinPx / px_per_m - (range.to - range.from)));
    range.from -= more_m;
    range.to += more_m;
  }
  double width_px() const { return (x.to - x.from) * px_per_m; }
  double height_px() const { return (y.to - y.from) * px_per_m; }
  double page_width_px() const {
    return std::max(kPageWidthMinPx, PlotAxes::kLeftPx + width_px() + PlotAxes::kRightPx);
  }

  AxisRange x{1e300, -1e300}, y{1e300, -1e300};
  double px_per_m = 1.0;
};

MapFrame::MapFrame(const std::vector<Eigen::Vector2d>& points_map, std::vector<LegendItem> legend)
    : MapFrame(Extent(points_map), std::move(legend)) {}

MapFrame::MapFrame(const Extent& extent, std::vector<LegendItem> legend)
    : px_per_m_(extent.px_per_m),
      page_width_px_(extent.page_width_px()),
      legend_(std::move(legend), page_width_px_ - 2.0 * kEdgePx),
      axes_({PlotAxes::kLeftPx, 2.0 * kEdgePx + legend_.height_px(),
             PlotAxes::kLeftPx + extent.width_px(),
             2.0 * kEdgePx + legend_.height_px() + extent.height_px()},
            extent.x, extent.y) {}

int MapFrame::width_px() const { return static_cast<int>(std::ceil(page_width_px_)); }

int MapFrame::height_px() const {
  return static_cast<int>(std::ceil(box().y1 + PlotAxes::kBottomPx));
}

void MapFrame::draw(Canvas& canvas) const {
  axes_.draw("x (m)", "y (m)", canvas);
  legend_.draw({kEdgePx, kEdgePx}, canvas);
  const double most_m = std::min(kScaleBarPx, 0.25 * box().width()) / px_per_m_;
  const double step_m = round_step(0.4 * most_m);  // steps grow by at most 2.5
  const double right = box().x1, left = right - step_m * px_per_m_, y = std::floor(box().y1) + 37.0;
  canvas.polyline({{left, y - kTickPx}, {left, y}, {right, y}, {right, y - kTickPx}}, kBlack, 2.0);
  canvas.text({left - 7.0, y + 5.0}, fixed_text(step_m, decimals_of(step_m)) + " m",
              {kAxisTextPx, kBlack, TextAnchor::kEnd});
}

void MapFrame::draw_path(const std::vector<pose::PoseEstimate>& path, Canvas& canvas) const {
  constexpr std::size_t kFewPoses = 50;  // where a stepped robot stood
  std::vector<PixelPoint> points;
  for (const pose::PoseEstimate& pose : path) points.push_back({pose.x_m, pose.y_m});
  axes_.draw_line(points, kPathColour, 2.0, canvas);
  if (points.size() > kFewPoses) return;
  for (const PixelPoint& p : points) canvas.circle(at(p.x, p.y), 2.0, kPathColour, kPathColour);
}

}  // namespace orchard::io
