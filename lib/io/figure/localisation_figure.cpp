// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/localisation_figure.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "io/figure/plot_axes.hpp"

namespace orchard::io {
namespace {

using evaluation::PlaceState;
using evaluation::ShadowMoment;

constexpr double kPanelWidth_px = 1000.0, kPanelHeight_px = 360.0, kPanelTop_px = 68.0;
constexpr double kErrorShown_m = 2.0;  ///< derived: beyond, an error is of another row anyway
constexpr Colour kErrorLine{200, 40, 30}, kClaimLine{30, 90, 200}, kLostBand{215, 215, 215};
constexpr Colour kAmbiguousBand{250, 235, 170};

void draw_bands(const std::vector<ShadowMoment>& moments, PlaceState state, Colour colour,
                const PlotAxes& axes, Canvas& canvas) {
  for (std::size_t i = 1; i < moments.size(); ++i) {
    if (moments[i].state != state) continue;
    const double x0 = axes.at(moments[i - 1].time_s, 0.0).x, x1 = axes.at(moments[i].time_s, 0.0).x;
    canvas.rectangle({x0, axes.box().y0, x1, axes.box().y1}, colour, std::nullopt);
  }
}

/// A line for each stretch of moments with a pose.
void draw_curve(const std::vector<ShadowMoment>& moments,
                const std::function<double(const ShadowMoment&)>& value_m, double most_m,
                Colour colour, const PlotAxes& axes, Canvas& canvas) {
  std::vector<PixelPoint> line;
  for (const ShadowMoment& m : moments) {
    if (m.error_m) line.push_back({m.time_s, std::min(value_m(m), most_m)});
    if (m.error_m && &m != &moments.back()) continue;
    if (line.size() > 1) axes.draw_line(line, colour, 2.0, canvas);
    line.clear();
  }
}

}  // namespace

std::string localisation_figure(const evaluation::LocalisationEvaluation& evaluation,
                                const std::string& title, FigureFormat format) {
  const std::vector<ShadowMoment>& moments = evaluation.moments;
  double most_m = 0.0;
  for (const ShadowMoment& m : moments) {
    if (m.error_m) most_m = std::max({most_m, *m.error_m, 2.0 * m.sd_m});
  }
  most_m = std::clamp(most_m, 0.1, kErrorShown_m);
  const PixelBox box{PlotAxes::kLeftPx, kPanelTop_px, PlotAxes::kLeftPx + kPanelWidth_px,
                     kPanelTop_px + kPanelHeight_px};
  const PlotAxes axes(box, {0.0, moments.empty() ? 1.0 : moments.back().time_s}, {0.0, most_m});
  Canvas canvas(format, static_cast<int>(std::ceil(box.x1 + PlotAxes::kRightPx)),
                static_cast<int>(std::ceil(box.y1 + PlotAxes::kBottomPx)));
  draw_bands(moments, PlaceState::kLost, kLostBand, axes, canvas);
  draw_bands(moments, PlaceState::kAmbiguous, kAmbiguousBand, axes, canvas);
  axes.draw("time (s)", "error (m)", canvas);
  draw_curve(
      moments, [](const ShadowMoment& m) { return 2.0 * m.sd_m; }, most_m, kClaimLine, axes,
      canvas);
  draw_curve(
      moments, [](const ShadowMoment& m) { return *m.error_m; }, most_m, kErrorLine, axes, canvas);
  canvas.text({box.x0, 26.0}, title, {16.0, kBlack});
  const auto patch = [](Colour colour) {
    return [colour](PixelPoint at, Canvas& c) {
      c.rectangle({at.x - 8.0, at.y - 6.0, at.x + 8.0, at.y + 6.0}, colour, kBlack);
    };
  };
  Legend({line_item("error", kErrorLine),
          line_item("twice the claimed sd", kClaimLine),
          {"LOST", patch(kLostBand)},
          {"AMBIGUOUS", patch(kAmbiguousBand)}},
         box.width())
      .draw({box.x0, 36.0}, canvas);
  return canvas.finish();
}

}  // namespace orchard::io
