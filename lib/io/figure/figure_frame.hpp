// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "io/figure/canvas.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::io {

inline constexpr double kAxisTextPx = 14.0;

struct PixelBox {
  double x0, y0, x1, y1;
  bool overlaps(const PixelBox& other) const {
    return x0 < other.x1 && other.x0 < x1 && y0 < other.y1 && other.y0 < y1;
  }
};

/// Where metres of the map lie in a picture of it.
class FigureFrame {
 public:
  /// So that all points have room; what is not finite is left out.
  explicit FigureFrame(const std::vector<Eigen::Vector2d>& points_map);

  PixelPoint at(double x_m, double y_m) const;
  PixelBox plot() const;
  double px_per_m() const { return px_per_m_; }
  int width_px() const;
  int height_px() const;
  /// Where a legend begins: above the plot, on its left.
  PixelPoint legend() const;

  /// Frame, grid, ticks in metres and their names.
  void draw_axes(Canvas& canvas) const;

  /// A robot's path; of few poses each one too.
  void draw_path(const std::vector<pose::PoseEstimate>& path, Canvas& canvas) const;

 private:
  void include(double x, double y);
  void widen(double& lo, double& hi) const;

  double x0_ = 1e300, y0_ = 1e300, x1_ = -1e300, y1_ = -1e300;
  double px_per_m_ = 1.0;
};

inline constexpr Colour kPathColour{60, 110, 200};

}  // namespace orchard::io
