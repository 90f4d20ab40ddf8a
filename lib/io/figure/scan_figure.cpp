// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/scan_figure.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "geometry/pose2.hpp"
#include "io/figure/plot_axes.hpp"
#include "laser/segment.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

constexpr double kSide_px = 900.0;
constexpr double kScanTop_px = 76.0;
constexpr int kArcSteps = 90;
constexpr double kLabel_px = 11.0;
constexpr Colour kReturn{40, 70, 160}, kRound{30, 140, 60}, kRefused{200, 120, 20},
    kBlind{200, 40, 30}, kReach{150, 150, 150};

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

bool contains(const laser::Segment& s, std::size_t beam) {
  if (s.first_beam <= s.last_beam) return s.first_beam <= beam && beam <= s.last_beam;
  return beam >= s.first_beam || beam <= s.last_beam;  // across the scan's seam
}

/// What would be objects, were they neither too wide nor hit by too few beams.
std::vector<laser::Segment> refused_segments(const laser::Scan& scan,
                                             const laser::LaserConfig& laser,
                                             const laser::SegmentationConfig& segmentation,
                                             const laser::WidthConfig& width,
                                             const std::vector<laser::Segment>& taken) {
  laser::SegmentationConfig any = segmentation;
  any.min_beams = 1;
  any.width_max_m = 2.0 * segmentation.range_max_m;  // nothing wider is in reach
  std::vector<laser::Segment> refused = laser::segment(scan, any, width, laser);
  const auto is_taken = [&](const laser::Segment& s) {
    return (s.num_beams >= segmentation.min_beams && s.width_m <= segmentation.width_max_m) ||
           std::any_of(taken.begin(), taken.end(),
                       [&](const auto& other) { return contains(s, other.middle_beam); });
  };
  refused.erase(std::remove_if(refused.begin(), refused.end(), is_taken), refused.end());
  return refused;
}

/// A ring as wide as the object, and what there is to say of it.
void draw_segment(const Above& above, const laser::Segment& s, const std::string& words,
                  Colour colour, LabelPlacement& labels, Canvas& canvas) {
  const PixelPoint middle = above.laser(s.range_m + 0.5 * s.width_m, s.bearing_rad);
  const double radius_px = std::max(4.0, above.pixels(0.5 * s.width_m));
  std::vector<PixelPoint> ring;
  for (int k = 0; k <= kArcSteps; ++k) {
    const double angle = 2.0 * geometry::kPi * k / kArcSteps;
    ring.push_back(
        {middle.x + radius_px * std::cos(angle), middle.y + radius_px * std::sin(angle)});
  }
  canvas.polyline(ring, colour, 1.5);
  draw_label(middle, radius_px, words, kLabel_px, colour, labels, &canvas);
}

std::string centimetres(double length_m) { return fixed_text(100.0 * length_m, 0) + " cm"; }

void draw_segments(const Above& above, const laser::Scan& scan, const laser::LaserConfig& laser,
                   const laser::SegmentationConfig& segmentation, const laser::WidthConfig& width,
                   Canvas& canvas) {
  LabelPlacement labels(above.box());
  const std::vector<laser::Segment> taken = laser::segment(scan, segmentation, width, laser);
  for (const laser::Segment& s : taken) {
    draw_segment(above, s, centimetres(s.width_m), kRound, labels, canvas);
  }
  for (const laser::Segment& s : refused_segments(scan, laser, segmentation, width, taken)) {
    const bool is_wide = s.width_m > segmentation.width_max_m;
    draw_segment(
        above, s,
        centimetres(s.width_m) +
            (is_wide ? ": too wide" : ": too few beams (" + std::to_string(s.num_beams) + ")"),
        kRefused, labels, canvas);
  }
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
  draw_segments(above, scan, laser, segmentation, width, canvas);
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    if (!scan.valid(i) || scan.ranges_m[i] > reach_m) continue;
    canvas.circle(above.laser(scan.ranges_m[i], scan.bearing_rad(static_cast<double>(i))), 1.5,
                  kReturn, kReturn);
  }
  draw_robot(above, canvas);
  canvas.text({above.box().x0, 26.0}, title, {16.0, kBlack});
  const auto dot = [](PixelPoint at, Canvas& c) { c.circle(at, 2.0, kReturn, kReturn); };
  Legend({{"return", dot},
          line_item("object, as wide as it was measured", kRound),
          line_item("refused", kRefused),
          line_item("blind sector", kBlind),
          line_item("reach of the detector", kReach)},
         above.box().width())
      .draw({above.box().x0, 40.0}, canvas);
  return canvas.finish();
}

}  // namespace orchard::io
