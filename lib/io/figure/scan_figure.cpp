// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/scan_figure.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "geometry/pose2.hpp"
#include "io/figure/plot_axes.hpp"
#include "laser/segment.hpp"

namespace orchard::io {
namespace {

constexpr double kSide_px = 900.0;
constexpr double kScanTop_px = 76.0;
constexpr int kArcSteps = 90;
constexpr Colour kReturn{40, 70, 160}, kRound{30, 140, 60}, kBlind{200, 40, 30},
    kReach{150, 150, 150};

/// A page in base: x up, y to the left.
class Above {
 public:
  Above(const laser::LaserConfig& laser, double reach_m)
      : T_base_laser_(laser.mount_x_m, laser.mount_y_m, laser.mount_yaw_rad),
        box_{PlotAxes::kLeftPx, kScanTop_px, PlotAxes::kLeftPx + kSide_px, kScanTop_px + kSide_px},
        axes_(box_, {reach_m, -reach_m}, {-reach_m, reach_m}) {}

  const PixelBox& box() const { return box_; }
  const PlotAxes& axes() const { return axes_; }
  PixelPoint base(double x_m, double y_m) const { return axes_.at(y_m, x_m); }
  PixelPoint laser(double range_m, double bearing_rad) const {
    const Eigen::Vector2d p = geometry::transform(
        T_base_laser_,
        Eigen::Vector2d(range_m * std::cos(bearing_rad), range_m * std::sin(bearing_rad)));
    return base(p.x(), p.y());
  }
  double pixels(double length_m) const {
    return std::abs(base(0.0, length_m).x - base(0.0, 0.0).x);
  }
  /// An arc about the scanner.
  std::vector<PixelPoint> arc(double range_m, double from_rad, double to_rad) const {
    std::vector<PixelPoint> points;
    for (int i = 0; i <= kArcSteps; ++i) {
      points.push_back(laser(range_m, from_rad + (to_rad - from_rad) * i / kArcSteps));
    }
    return points;
  }

 private:
  Eigen::Vector3d T_base_laser_;
  PixelBox box_;
  PlotAxes axes_;
};

void draw_robot(const Above& above, Canvas& canvas) {
  canvas.polygon({above.base(0.35, 0.0), above.base(-0.25, 0.2), above.base(-0.25, -0.2)}, kBlack,
                 std::nullopt);
}

void draw_blind(const Above& above, const laser::BlindSector& blind, double reach_m,
                Canvas& canvas) {
  if (!(blind.half_width_rad > 0.0)) return;
  std::vector<PixelPoint> sector =
      above.arc(0.25 * reach_m, blind.centre_rad - blind.half_width_rad,
                blind.centre_rad + blind.half_width_rad);
  sector.push_back(above.laser(0.0, 0.0));
  canvas.polygon(sector, std::nullopt, kBlind, 1.5);
}

}  // namespace

std::string scan_figure(const laser::Scan& scan, const laser::LaserConfig& laser,
                        const laser::SegmentationConfig& segmentation,
                        const laser::WidthConfig& width, const std::string& title,
                        FigureFormat format) {
  const double reach_m = 1.1 * segmentation.range_max_m;
  const Above above(laser, reach_m);
  Canvas canvas(format, static_cast<int>(std::ceil(above.box().x1 + PlotAxes::kRightPx)),
                static_cast<int>(std::ceil(above.box().y1 + PlotAxes::kBottomPx)));
  above.axes().draw("y (m), to the left", "x (m), ahead", canvas);
  canvas.polyline(above.arc(segmentation.range_max_m, -geometry::kPi, geometry::kPi), kReach, 1.0,
                  true);
  draw_blind(above, segmentation.blind_sector(), reach_m, canvas);
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    if (!scan.valid(i) || scan.ranges_m[i] > reach_m) continue;
    canvas.circle(above.laser(scan.ranges_m[i], scan.bearing_rad(static_cast<double>(i))), 1.5,
                  kReturn, kReturn);
  }
  for (const laser::Segment& s : laser::segment(scan, segmentation, width, laser)) {
    const PixelPoint middle = above.laser(s.range_m + 0.5 * s.width_m, s.bearing_rad);
    const double radius = std::max(4.0, above.pixels(0.5 * s.width_m));
    std::vector<PixelPoint> ring;
    for (int k = 0; k <= kArcSteps; ++k) {
      const double angle = 2.0 * geometry::kPi * k / kArcSteps;
      ring.push_back({middle.x + radius * std::cos(angle), middle.y + radius * std::sin(angle)});
    }
    canvas.polyline(ring, kRound, 1.5);
  }
  draw_robot(above, canvas);
  canvas.text({above.box().x0, 26.0}, title, {16.0, kBlack});
  const auto dot = [](PixelPoint at, Canvas& c) { c.circle(at, 2.0, kReturn, kReturn); };
  Legend({{"return", dot},
          line_item("object, as wide as it was measured", kRound),
          line_item("blind sector", kBlind),
          line_item("reach of the detector", kReach)},
         above.box().width())
      .draw({above.box().x0, 40.0}, canvas);
  return canvas.finish();
}

}  // namespace orchard::io
