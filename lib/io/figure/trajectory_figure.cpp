// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/trajectory_figure.hpp"

#include <algorithm>
#include <vector>

#include "io/figure/canvas.hpp"
#include "io/figure/plot_axes.hpp"
#include "io/fixed_text.hpp"

namespace orchard::io {
namespace {

using evaluation::ComparedPose;
using evaluation::Track;
using evaluation::TrackPose;
using evaluation::TrajectoryEvaluation;

constexpr int kWidthPx = 1200, kHeightPx = 1150;
constexpr double kLeftPx = 70.0, kPlotWidthPx = 1100.0, kPathTopPx = 70.0, kPathHeightPx = 720.0,
                 kErrorTopPx = 880.0, kErrorHeightPx = 200.0;
constexpr Colour kBlack{30, 30, 30}, kTruth{150, 150, 150}, kPath{60, 110, 200},
    kError{200, 60, 50};

struct Range {
  double low = 1e300, high = -1e300;
  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

void draw(const TrajectoryEvaluation& evaluation, const Track& truth, Canvas& canvas) {
  Range x, y;
  std::vector<PixelPoint> true_path, path, errors;
  for (const TrackPose& pose : truth.poses) {
    x.include(pose.x_m);
    y.include(pose.y_m);
    true_path.push_back({pose.x_m, pose.y_m});
  }
  for (const ComparedPose& pair : evaluation.compared) {
    x.include(pair.estimate.x_m);
    y.include(pair.estimate.y_m);
    path.push_back({pair.estimate.x_m, pair.estimate.y_m});
    errors.push_back({pair.way_m, pair.position_error_m});
  }
  const double way_m = errors.empty() ? 1.0 : errors.back().x;
  const PlotAxes paths({kLeftPx, kPathTopPx}, kPlotWidthPx, kPathHeightPx, x.low, x.high, y.low,
                       y.high, true);
  paths.draw("x (m)", "y (m)", canvas);
  paths.draw_line(true_path, kTruth, 4.0, canvas);
  paths.draw_line(path, kPath, 1.5, canvas);
  const PlotAxes over_way({kLeftPx, kErrorTopPx}, kPlotWidthPx, kErrorHeightPx, 0.0, way_m, 0.0,
                          1.05 * evaluation.position_m.max, false);
  over_way.draw("distance driven (m)", "position error (m)", canvas);
  over_way.draw_line(errors, kError, 1.5, canvas);
  canvas.text({kLeftPx, 30.0},
              "position error: RMSE " + fixed_text(evaluation.position_m.rmse, 3) + " m, median " +
                  fixed_text(evaluation.position_m.median, 3) + " m, largest " +
                  fixed_text(evaluation.position_m.max, 3) + " m over " + fixed_text(way_m, 0) +
                  " m",
              18.0, kBlack, TextAnchor::kStart);
  canvas.text({kLeftPx + kPlotWidthPx - 130.0, 56.0}, "truth", 14.0, kTruth, TextAnchor::kEnd);
  canvas.text({kLeftPx + kPlotWidthPx, 56.0}, "estimate", 14.0, kPath, TextAnchor::kEnd);
}

}  // namespace

TrajectoryFigure draw_trajectory(const TrajectoryEvaluation& evaluation, const Track& truth) {
  TrajectoryFigure figure;
  const auto svg = make_svg_canvas(kWidthPx, kHeightPx);
  draw(evaluation, truth, *svg);
  figure.svg = svg->bytes();
  const auto png = make_png_canvas(kWidthPx, kHeightPx);
  draw(evaluation, truth, *png);
  figure.png = png->bytes();
  return figure;
}

}  // namespace orchard::io
