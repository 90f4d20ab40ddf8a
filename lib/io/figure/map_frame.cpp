// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/map_frame.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/thinned_line.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

constexpr double kPlotMinPx = 220.0;  // a map of one row would otherwise be too narrow for axes
constexpr double kPageWidthMinPx = 420.0;
constexpr double kEdgePx = 14.0;    // page's edge to legend, and legend to plot
constexpr double kMarginPx = 32.0;  // from the outermost point to the frame: space for a label
constexpr double kMarginMin_m = 0.3;
constexpr double kScaleBarPx = 150.0;  // max length
constexpr double kScaleBarTick_px = 4.0;
constexpr double kTitleTextPx = 17.0, kTitlePx = 28.0;  // text height, and line height
constexpr double kArrowPx = 44.0;                       // north arrow with its letter and spacing

/// Shortens a text to the given width, with dots at the end.
std::string shortened(const std::string& text, double width_px, bool is_bold) {
  if (text_width_px(text, kTitleTextPx, is_bold) <= width_px) return text;
  for (std::size_t length = text.size(); length > 0; --length) {
    // Do not cut inside a UTF-8 character.
    if ((static_cast<unsigned char>(text[length - 1]) & 0xC0u) >= 0x80u && length < text.size() &&
        (static_cast<unsigned char>(text[length]) & 0xC0u) == 0x80u) {
      continue;
    }
    const std::string part = text.substr(0, length) + "...";
    if (text_width_px(part, kTitleTextPx, is_bold) <= width_px) return part;
  }
  return {};
}

}  // namespace

/// The part of the map that is drawn.
struct MapFrame::Extent {
  Extent(const std::vector<Eigen::Vector2d>& points_map, PlotSizeMax size_max) {
    for (const Eigen::Vector2d& p : points_map) {
      if (!p.allFinite()) continue;
      x.from = std::min(x.from, p.x()), x.to = std::max(x.to, p.x());
      y.from = std::min(y.from, p.y()), y.to = std::max(y.to, p.y());
    }
    if (x.from > x.to) x = y = {-1.0, 1.0};
    const double width_m = x.to - x.from, height_m = y.to - y.from;
    // The margin is given in pixels, with a minimum in metres.
    const double per_px = std::max({width_m / (size_max.width_px - 2.0 * kMarginPx),
                                    height_m / (size_max.height_px - 2.0 * kMarginPx), 1e-9});
    const double margin_m = std::max(kMarginMin_m, kMarginPx * per_px);
    px_per_m = std::min(size_max.width_px / (width_m + 2.0 * margin_m),
                        size_max.height_px / (height_m + 2.0 * margin_m));
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

MapFrame::MapFrame(const std::vector<Eigen::Vector2d>& points_map, std::vector<LegendItem> legend,
                   MapHeading heading, PlotSizeMax size_max)
    : MapFrame(Extent(points_map, size_max), std::move(legend), std::move(heading)) {}

MapFrame::MapFrame(const Extent& extent, std::vector<LegendItem> legend, MapHeading heading)
    : px_per_m_(extent.px_per_m),
      page_width_px_(extent.page_width_px()),
      heading_(std::move(heading)),
      legend_(std::move(legend), page_width_px_ - 2.0 * kEdgePx - arrow_px()),
      axes_({PlotAxes::kLeftPx, top_px(), PlotAxes::kLeftPx + extent.width_px(),
             top_px() + extent.height_px()},
            extent.x, extent.y) {}

double MapFrame::arrow_px() const { return heading_.north_rad ? kArrowPx : 0.0; }

/// Top of the plot, below heading and legend.
double MapFrame::top_px() const {
  const bool has_title = !heading_.title.empty() || !heading_.day.empty();
  const double text_px = (has_title ? kTitlePx : 0.0) + legend_.height_px();
  return 2.0 * kEdgePx + std::max(text_px, arrow_px());
}

int MapFrame::width_px() const { return static_cast<int>(std::ceil(page_width_px_)); }

int MapFrame::height_px() const {
  return static_cast<int>(std::ceil(box().y1 + PlotAxes::kBottomPx));
}

void MapFrame::draw(Canvas& canvas) const {
  axes_.draw("x (m)", "y (m)", canvas);
  draw_heading(canvas);
  const double most_m = std::min(kScaleBarPx, 0.25 * box().width()) / px_per_m_;
  const double step_m = round_step(0.4 * most_m);  // round steps differ by a factor of at most 2.5
  const double right = box().x1, left = right - step_m * px_per_m_, y = std::floor(box().y1) + 37.0;
  canvas.polyline(
      {{left, y - kScaleBarTick_px}, {left, y}, {right, y}, {right, y - kScaleBarTick_px}}, kBlack,
      2.0);
  canvas.text({left - 7.0, y + 5.0}, fixed_text(step_m, decimals_of(step_m)) + " m",
              {kAxisTextPx, kBlack, TextAnchor::kEnd});
}

void MapFrame::draw_heading(Canvas& canvas) const {
  double top = kEdgePx;
  if (!heading_.title.empty() || !heading_.day.empty()) {
    const double right = page_width_px_ - kEdgePx - arrow_px();
    const double day_px = text_width_px(heading_.day, kTitleTextPx);
    const double gap_px = heading_.day.empty() ? 0.0 : kEdgePx;
    const std::string title = shortened(heading_.title, right - kEdgePx - day_px - gap_px, true);
    canvas.text({kEdgePx, top + kTitleTextPx}, title, {kTitleTextPx, kBlack, {}, true});
    canvas.text({right, top + kTitleTextPx}, heading_.day,
                {kTitleTextPx, kBlack, TextAnchor::kEnd});
    top += kTitlePx;
  }
  legend_.draw({kEdgePx, top}, canvas);
  if (heading_.north_rad) draw_arrow(canvas);
}

void MapFrame::draw_arrow(Canvas& canvas) const {
  constexpr double kLengthPx = 13.0, kHalfWidthPx = 6.0, kLetterPx = 12.0;
  const PixelPoint centre{page_width_px_ - kEdgePx - 0.5 * kArrowPx + 6.0,
                          kEdgePx + 0.5 * kArrowPx};
  const double dx = std::cos(*heading_.north_rad), dy = -std::sin(*heading_.north_rad);
  const auto at = [&](double along_px, double across_px) {
    return PixelPoint{centre.x + along_px * dx - across_px * dy,
                      centre.y + along_px * dy + across_px * dx};
  };
  const PixelPoint tip = at(kLengthPx, 0.0), foot = at(-0.4 * kLengthPx, 0.0);
  canvas.polygon({tip, at(-kLengthPx, -kHalfWidthPx), foot}, kBlack, kBlack);
  canvas.polygon({tip, at(-kLengthPx, kHalfWidthPx), foot}, kWhite, kBlack);
  const PixelPoint letter = at(kLengthPx + 8.0, 0.0);
  canvas.text({letter.x, letter.y + 0.36 * kLetterPx}, "N",
              {kLetterPx, kBlack, TextAnchor::kMiddle, true});
}

void MapFrame::draw_path(const std::vector<pose::PoseEstimate>& path, Canvas& canvas) const {
  constexpr std::size_t kFewPoses = 50;  // stops of a robot that moves in steps
  constexpr double kThinned_px = 0.1;    // nobody sees it, and the files are a quarter smaller
  std::vector<Eigen::Vector2d> line;
  for (const pose::PoseEstimate& pose : path) line.emplace_back(pose.x_m, pose.y_m);
  std::vector<PixelPoint> points;
  for (const Eigen::Vector2d& p : geometry::thinned_line(line, kThinned_px / px_per_m_)) {
    points.push_back({p.x(), p.y()});
  }
  axes_.draw_line(points, kPathColour, 2.0, canvas);
  if (path.size() > kFewPoses) return;
  for (const Eigen::Vector2d& p : line) {
    canvas.circle(at(p.x(), p.y()), 2.0, kPathColour, kPathColour);
  }
}

}  // namespace orchard::io
