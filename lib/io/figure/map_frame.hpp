// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "io/figure/canvas.hpp"
#include "io/figure/legend.hpp"
#include "io/figure/plot_axes.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::io {

inline constexpr Colour kPathColour{60, 110, 200};

/// What stands above a map.
struct MapHeading {
  std::string title{};                ///< shortened where the page is narrow; empty: none
  std::string day{};                  ///< of the drive; empty: not known
  std::optional<double> north_rad{};  ///< direction of north in map; none: not tied to the earth
};

/// The largest plot that a figure has.
struct PlotSizeMax {
  double width_px = 1100.0, height_px = 800.0;
};

/// A page for a map: axes in metres of equal scale with room for all points, heading and legend
/// above, a scale bar below.
class MapFrame {
 public:
  /// What is not finite is left out of the extent. The page is wide enough for the legend.
  MapFrame(const std::vector<Eigen::Vector2d>& points_map, std::vector<LegendItem> legend,
           MapHeading heading = {}, PlotSizeMax size_max = {});

  PixelPoint at(double x_m, double y_m) const { return axes_.at(x_m, y_m); }
  const PixelBox& box() const { return axes_.box(); }
  double px_per_m() const { return px_per_m_; }
  int width_px() const;
  int height_px() const;

  /// Axes, heading with a north arrow, legend and scale bar.
  void draw(Canvas& canvas) const;

  /// A robot's path; of few poses each one too.
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
