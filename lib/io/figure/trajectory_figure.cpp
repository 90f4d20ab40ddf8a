// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/trajectory_figure.hpp"

#include <algorithm>
#include <vector>

#include "io/figure/legend.hpp"
#include "io/figure/plot_axes.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

using evaluation::ComparedPose;
using evaluation::Track;
using evaluation::TrackPose;
using evaluation::TrajectoryEvaluation;

constexpr int kWidthPx = 1200, kHeightPx = 1150;
constexpr PixelBox kPathBox{70.0, 75.0, 1170.0, 815.0}, kErrorBox{70.0, 890.0, 1170.0, 1090.0};
constexpr Colour kTruth{150, 150, 150}, kPath{60, 110, 200}, kError{200, 60, 50};

void include(double value, AxisRange& range) {
  range.from = std::min(range.from, value);
  range.to = std::max(range.to, value);
}

/// Adds the same margin to both ends.
AxisRange with_margin(AxisRange range) {
  const double margin = 0.04 * (range.to - range.from);
  return {range.from - margin, range.to + margin};
}

}  // namespace

std::string trajectory_figure(const TrajectoryEvaluation& evaluation, const Track& truth,
                              FigureFormat format) {
  AxisRange x{1e300, -1e300}, y{1e300, -1e300};
  std::vector<PixelPoint> true_path, path, errors;
  for (const TrackPose& pose : truth.poses) {
    include(pose.x_m, x);
    include(pose.y_m, y);
    true_path.push_back({pose.x_m, pose.y_m});
  }
  for (const ComparedPose& pair : evaluation.compared) {
    include(pair.estimate.x_m, x);
    include(pair.estimate.y_m, y);
    path.push_back({pair.estimate.x_m, pair.estimate.y_m});
    errors.push_back({pair.way_m, pair.position_error_m});
  }
  const double way_m = errors.empty() ? 1.0 : errors.back().x;
  Canvas canvas(format, kWidthPx, kHeightPx);
  canvas.text({kPathBox.x0, 30.0},
              "position error: RMSE " + fixed_text(evaluation.position_m.rmse, 3) + " m, median " +
                  fixed_text(evaluation.position_m.median, 3) + " m, largest " +
                  fixed_text(evaluation.position_m.max, 3) + " m over " + fixed_text(way_m, 0) +
                  " m",
              {18.0, kBlack});
  Legend({line_item("truth", kTruth), line_item("estimate", kPath)}, kPathBox.width())
      .draw({kPathBox.x0, 42.0}, canvas);
  const auto paths = PlotAxes::equal_scale(kPathBox, with_margin(x), with_margin(y));
  paths.draw("x (m)", "y (m)", canvas);
  paths.draw_line(true_path, kTruth, 4.0, canvas);
  paths.draw_line(path, kPath, 1.5, canvas);
  const PlotAxes over_way(kErrorBox, {0.0, way_m}, {0.0, 1.05 * evaluation.position_m.max});
  over_way.draw("distance driven (m)", "position error (m)", canvas);
  over_way.draw_line(errors, kError, 1.5, canvas);
  return canvas.finish();
}

}  // namespace orchard::io
