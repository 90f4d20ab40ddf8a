// SPDX-License-Identifier: BSD-3-Clause
#include "vision/line_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace orchard::vision {
namespace {

/// Step between two tried slopes, in columns at the bottom row.
constexpr int kShiftStep_px = 2;

struct Moments {
  double x_mean = 0.0, y_mean = 0.0;
  double xx = 0.0, xy = 0.0, yy = 0.0;  ///< sums of squares about the mean
};

Moments moments_of(const std::vector<EdgePoint>& points) {
  // Integer sums are exact in any order.
  std::int64_t sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0;
  for (const EdgePoint& p : points) {
    const std::int64_t x = p.x_px, y = p.y_px;
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
    syy += y * y;
  }
  const auto n = static_cast<double>(points.size());
  Moments m;
  m.x_mean = static_cast<double>(sx) / n;
  m.y_mean = static_cast<double>(sy) / n;
  m.xx = static_cast<double>(sxx) - n * m.x_mean * m.x_mean;
  m.xy = static_cast<double>(sxy) - n * m.x_mean * m.y_mean;
  m.yy = static_cast<double>(syy) - n * m.y_mean * m.y_mean;
  return m;
}

}  // namespace

double Line::x_at(double y_px) const { return x_mean_px + std::tan(tilt_rad) * (y_px - y_mean_px); }

std::optional<Line> fit_total_least_squares(const std::vector<EdgePoint>& points) {
  if (points.size() < 2) return std::nullopt;
  const Moments m = moments_of(points);
  const double half_trace = 0.5 * (m.xx + m.yy);
  const double root = std::hypot(0.5 * (m.yy - m.xx), m.xy);
  const double lambda_max = half_trace + root;
  if (!(lambda_max > 0.0)) return std::nullopt;
  const double lambda_min = std::max(half_trace - root, 0.0);
  Line line;
  line.x_mean_px = m.x_mean;
  line.y_mean_px = m.y_mean;
  // Angle of the principal axis from the vertical.
  line.tilt_rad = 0.5 * std::atan2(2.0 * m.xy, m.yy - m.xx);
  line.straightness = 1.0 - lambda_min / lambda_max;
  return line;
}

std::optional<Line> fit_regression(const std::vector<EdgePoint>& points) {
  if (points.size() < 2) return std::nullopt;
  const Moments m = moments_of(points);
  if (!(m.yy > 0.0)) return std::nullopt;
  Line line;
  line.x_mean_px = m.x_mean;
  line.y_mean_px = m.y_mean;
  line.tilt_rad = std::atan(m.xy / m.yy);
  // R^2 of the regression (Shalal et al. 2013, section 4.2 and figure 9)
  line.straightness = m.xx > 0.0 ? std::clamp(m.xy * m.xy / (m.xx * m.yy), 0.0, 1.0) : 0.0;
  return line;
}

std::vector<EdgePoint> points_of_best_line(const std::vector<EdgePoint>& points, int width_px,
                                           int height_px, double expected_x_px, double inlier_px,
                                           double max_tilt_rad) {
  // A line is given by its column in the top row and its shift in columns down to the bottom row.
  // All lines are tried in steps no coarser than the tolerance and scored by their number of
  // points. An edge is one pixel wide, so this is the number of rows that it covers.
  const int last_row = std::max(height_px - 1, 1);
  const int max_shift = static_cast<int>(std::tan(max_tilt_rad) * last_row);
  const int reach = std::max(static_cast<int>(std::lround(inlier_px)), 0);
  const double middle_y_px = 0.5 * (height_px - 1);
  int best_points = 0;
  double best_distance_px = 0.0, best_top = 0.0, best_slope = 0.0;
  // One column for each position at which a line near the window may cross the top row.
  const int border = max_shift + reach + 1;
  std::vector<int> padded(static_cast<std::size_t>(width_px + 2 * (border + reach)));
  int* const columns = padded.data() + reach;
  for (int shift = -max_shift; shift <= max_shift; shift += kShiftStep_px) {
    const double slope = static_cast<double>(shift) / last_row;
    // Only these columns have lines with this shift that pass through the window.
    const int first = border - std::max(shift, 0) - reach;
    const int last = border + width_px - std::min(shift, 0) + reach;
    std::fill(padded.begin(), padded.end(), 0);
    for (const EdgePoint& p : points) {
      ++columns[static_cast<int>(p.x_px - slope * p.y_px + (border + 0.5))];
    }
    int num_points = 0;
    for (int i = first; i <= last; ++i) {
      num_points += columns[i + reach];
      if (num_points > 0 && num_points >= best_points) {
        const int top = i - border;
        const double distance_px = std::abs(top + slope * middle_y_px - expected_x_px);
        if (num_points > best_points || distance_px < best_distance_px) {
          best_points = num_points;
          best_distance_px = distance_px;
          best_top = top;
          best_slope = slope;
        }
      }
      num_points -= columns[i - reach];
    }
  }
  std::vector<EdgePoint> inliers;
  if (best_points == 0) return inliers;
  for (const EdgePoint& p : points) {
    if (std::abs(p.x_px - (best_top + best_slope * p.y_px)) <= inlier_px) inliers.push_back(p);
  }
  return inliers;
}

}  // namespace orchard::vision
