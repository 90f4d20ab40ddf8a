// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "io/figure/canvas.hpp"
#include "io/figure/legend.hpp"
#include "io/figure/plot_axes.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::io {

inline constexpr Colour kPathColour{60, 110, 200};

/// A page for a map: axes in metres of equal scale with room for all points, the legend above, a
/// scale bar below.
class MapFrame {
 public:
  /// What is not finite is left out of the extent. The page is wide enough for the legend.
  MapFrame(const std::vector<Eigen::Vector2d>& points_map, std::vector<LegendItem> legend);

  PixelPoint at(double x_m, double y_m) const { return axes_.at(x_m, y_m); }
  const PixelBox& box() const { return axes_.box(); }
  double px_per_m() const { return px_per_m_; }
  int width_px() const;
  int height_px() const;

  /// Axes, legend and scale bar.
  void draw(Canvas& canvas) const;

  /// A robot's path; of few poses each one too.
  void draw_path(const std::vector<pose::PoseEstimate>& path, Canvas& canvas) const;

 private:
  struct Extent;
  MapFrame(const Extent& extent, std::vector<LegendItem> legend);

  double px_per_m_;
  double page_width_px_;
  Legend legend_;
  PlotAxes axes_;
};

}  // namespace orchard::io
