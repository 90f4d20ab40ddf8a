// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/plots_figure.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "io/figure/legend.hpp"
#include "io/figure/plot_axes.hpp"

namespace orchard::io {
namespace {

using evaluation::Plot;
using evaluation::PlotSeries;

constexpr int kColumns = 2;
constexpr int kPlotWidth_px = 560, kPlotHeight_px = 420;  // one plot with title, legend and axes
constexpr double kTitle_px = 28.0, kLegend_px = 70.0;
constexpr std::array<Colour, 7> kColours{{{27, 120, 55},
                                          {33, 102, 172},
                                          {178, 24, 43},
                                          {224, 130, 20},
                                          {118, 42, 131},
                                          {51, 51, 51},
                                          {1, 160, 160}}};
constexpr Colour kReference{153, 153, 153};

void draw_series(const PlotSeries& series, const Plot& plot, Colour colour, const PlotAxes& axes,
                 Canvas& canvas) {
  std::vector<PixelPoint> points;
  for (const auto& [x, y] : series.points) {
    if (!std::isfinite(x) || !std::isfinite(y)) continue;
    points.push_back(
        axes.at(std::clamp(x, plot.x_min, plot.x_max), std::clamp(y, plot.y_min, plot.y_max)));
  }
  if (series.has_line) {
    canvas.polyline(points, colour, series.is_reference ? 1.0 : 1.8, series.is_reference);
  }
  if (!series.has_marks) return;
  for (const PixelPoint& p : points) canvas.circle(p, 3.0, colour, colour);
}

void draw_plot(const Plot& plot, PixelPoint corner, Canvas& canvas) {
  const PixelBox box{corner.x + PlotAxes::kLeftPx, corner.y + kTitle_px + kLegend_px,
                     corner.x + kPlotWidth_px - PlotAxes::kRightPx,
                     corner.y + kPlotHeight_px - PlotAxes::kBottomPx};
  canvas.text({0.5 * (box.x0 + box.x1), corner.y + 20.0}, plot.title,
              {15.0, kBlack, TextAnchor::kMiddle, true});
  const PlotAxes axes(box, {plot.x_min, plot.x_max}, {plot.y_min, plot.y_max});
  axes.draw(plot.x_label, plot.y_label, canvas);
  std::vector<LegendItem> names;
  std::size_t next_colour = 0;
  for (const PlotSeries& series : plot.series) {
    const Colour colour =
        series.is_reference ? kReference : kColours[next_colour++ % kColours.size()];
    draw_series(series, plot, colour, axes, canvas);
    if (!series.name.empty()) names.push_back(line_item(series.name, colour));
  }
  const Legend legend(std::move(names), box.width());
  legend.draw({box.x0, box.y0 - 4.0 - legend.height_px()}, canvas);
}

}  // namespace

std::string plots_figure(const std::vector<Plot>& plots, FigureFormat format) {
  const int num = std::max(1, static_cast<int>(plots.size()));
  const int rows = (num + kColumns - 1) / kColumns;
  Canvas canvas(format, std::min(num, kColumns) * kPlotWidth_px, rows * kPlotHeight_px);
  for (std::size_t i = 0; i < plots.size(); ++i) {
    const int column = static_cast<int>(i) % kColumns, row = static_cast<int>(i) / kColumns;
    draw_plot(plots[i], {1.0 * column * kPlotWidth_px, 1.0 * row * kPlotHeight_px}, canvas);
  }
  return canvas.finish();
}

}  // namespace orchard::io
