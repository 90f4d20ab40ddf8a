// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "io/figure/canvas.hpp"
#include "io/figure/palette.hpp"
#include "io/figure/plot_axes.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::io {

/// Heading above a map.
struct MapHeading {
  std::string title{};                ///< shortened on a narrow page; empty: none
  std::string day{};                  ///< date of the drive; empty: unknown
  std::optional<double> north_rad{};  ///< direction of north in map; none: not georeferenced
};

/// Max size of a figure's plot.
struct PlotSizeMax {
  double width_px = 1100.0, height_px = 800.0;
};

/// Page layout of a map: axes in metres of equal scale that contain all points, heading and legend
/// above, scale bar below.
class MapFrame {
 public:
  /// Non-finite points are ignored. The page is wide enough for the legend.
  MapFrame(const std::vector<Eigen::Vector2d>& points_map, std::vector<LegendItem> legend,
           MapHeading heading = {}, PlotSizeMax size_max = {});

  PixelPoint at(double x_m, double y_m) const { return axes_.at(x_m, y_m); }
  const PixelBox& box() const { return axes_.box(); }
  double px_per_m() const { return px_per_m_; }
  int width_px() const;
  int height_px() const;

  /// Draws axes, heading with north arrow, legend and scale bar.
  void draw(Canvas& canvas) const;

  /// Draws a robot's path; if it has few poses, also each pose.
  void draw_path(const std::vector<pose::PoseEstimate>& path, Canvas& canvas) const;

 private:
  struct Extent;
  MapFrame(const Extent& extent, std::vector<LegendItem> legend, MapHeading heading);
  double top_px() const;
  double arrow_px() const;
  void draw_heading(Canvas& canvas) const;
  void draw_arrow(Canvas& canvas) const;

  double px_per_m_;
  double page_width_px_;
  MapHeading heading_;
  Legend legend_;
  PlotAxes axes_;
};

}  // namespace orchard::io
