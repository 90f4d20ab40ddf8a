// SPDX-License-Identifier: BSD-3-Clause
#include "vision/edges.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>
#include <vector>

#include "vision/block_view.hpp"
#include "vision/canny.hpp"
#include "vision/line_fit.hpp"

namespace orchard::vision {
namespace {

/// Max distance of an edge pixel from its line [px]; Canny localises an edge to one pixel.
constexpr double kInlier_px = 1.0;

/// Angle between two edges at which roc_parallel reaches 0 [deg].
constexpr double kParallelTolerance_deg = 10;

constexpr double kRadPerDeg = 3.14159265358979323846 / 180.0;

/// The map's edge pixels inside the window, relative to its top left corner, row by row.
std::vector<EdgePoint> edge_points(const EdgeMap& map, const PixelRect& window) {
  std::vector<EdgePoint> points;
  points.reserve(256);
  for (int y = 0; y < window.height_px; ++y) {
    const std::uint8_t* row = map.edges.data() +
                              static_cast<std::size_t>(window.y_px - map.area.y_px + y) *
                                  static_cast<std::size_t>(map.area.width_px) +
                              static_cast<std::size_t>(window.x_px - map.area.x_px);
    for (int x = 0; x < window.width_px; ++x) {
      if (row[x] != 0) points.push_back({x, y});
    }
  }
  return points;
}

std::vector<EdgePoint> points_near(const std::vector<EdgePoint>& points, const Line& line,
                                   double distance_px) {
  const double slope = std::tan(line.tilt_rad);
  std::vector<EdgePoint> near;
  near.reserve(points.size());
  for (const EdgePoint& p : points) {
    const double x_px = line.x_mean_px + slope * (p.y_px - line.y_mean_px);
    if (std::abs(p.x_px - x_px) <= distance_px) near.push_back(p);
  }
  return near;
}

int num_rows_of(const std::vector<EdgePoint>& points) {
  int rows = 0, previous = -1;
  for (const EdgePoint& p : points) {
    if (p.y_px != previous) ++rows;
    previous = p.y_px;
  }
  return rows;
}

}  // namespace

PixelRect edge_reading_area(const PixelRect& window, const PixelRect& picture) {
  // Half the median filter, one pixel for the gradient, one for non-maximum suppression.
  const int border = EdgeConfig::kMedianSize_px / 2 + 2;
  return intersection({window.x_px - border, window.y_px - border, window.width_px + 2 * border,
                       window.height_px + 2 * border},
                      picture);
}

EdgeMap edge_map(const PixelBlock& pixels, const EdgeConfig& config) {
  return edge_map(pixels, pixels.area, config);
}

EdgeMap edge_map(const PixelBlock& pixels, const PixelRect& area, const EdgeConfig& config) {
  EdgeMap map;
  map.area = area;
  cv::Mat grey;
  cv::cvtColor(view_of(pixels, area), grey, cv::COLOR_BGR2GRAY);
  cv::medianBlur(grey, grey, EdgeConfig::kMedianSize_px);
  map.edges = canny(grey.data, grey.cols, grey.rows, config.canny_low, config.canny_high);
  return map;
}

EdgeLine find_edge(const EdgeMap& map, const PixelRect& window, double expected_x_px,
                   const EdgeConfig& config) {
  if (window.empty() || !map.area.contains(window)) {
    throw std::invalid_argument("the window does not lie inside the edge map");
  }
  const double max_tilt_rad = config.max_tilt_deg * kRadPerDeg;
  const std::vector<EdgePoint> points = edge_points(map, window);
  std::optional<Line> line;
  double roc = 0.0;
  const auto min_points = static_cast<std::size_t>(config.min_points);
  if (config.fit == LineFit::kRegression) {
    if (points.size() >= min_points) line = fit_regression(points);
    if (line) roc = line->straightness;
  } else if (points.size() >= min_points) {
    std::vector<EdgePoint> inliers =
        points_of_best_line(points, window.width_px, window.height_px, expected_x_px - window.x_px,
                            kInlier_px, max_tilt_rad);
    if (inliers.size() >= min_points) line = fit_total_least_squares(inliers);
    if (line) {  // refit with the inliers of the fitted line instead of those of the search
      inliers = points_near(points, *line, kInlier_px);
      line = inliers.size() >= min_points ? fit_total_least_squares(inliers) : std::nullopt;
    }
    if (line) roc = line->straightness * num_rows_of(inliers) / window.height_px;
  }
  EdgeLine edge;
  if (!line || std::abs(line->tilt_rad) > max_tilt_rad) return edge;
  edge.found = true;
  edge.x_px = window.x_px + line->x_at(0.5 * (window.height_px - 1));
  edge.tilt_rad = line->tilt_rad;
  edge.roc = roc;
  return edge;
}

double parallel_confidence(const EdgeLine& left, const EdgeLine& right) {
  if (!left.found || !right.found) return 0.0;
  const double angle_deg = std::abs(left.tilt_rad - right.tilt_rad) / kRadPerDeg;
  return std::max(0.0, 1.0 - angle_deg / kParallelTolerance_deg);
}

}  // namespace orchard::vision
