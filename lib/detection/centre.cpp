// SPDX-License-Identifier: BSD-3-Clause
#include "detection/centre.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/pose2.hpp"
#include "geometry/statistics.hpp"

namespace orchard::detection {
namespace {

struct Estimate {
  double mean = 0.0;
  double variance = 0.0;
};

/// Mean and variance of a trunk's radius in the width model.
Estimate model_radius(const Rig& rig) {
  const laser::WidthConfig& trunks = rig.detector.width;
  return {0.5 * trunks.mean_m,
          0.25 * geometry::square(std::max(trunks.sd_m, laser::WidthConfig::kSdFloor_m))};
}

Estimate radius_of(const laser::Segment& segment, bool is_trunk, const Rig& rig) {
  const Estimate measured{0.5 * segment.width_m,
                          0.25 * geometry::square(std::max(segment.width_sd_m, 1e-4))};
  if (!is_trunk) return measured;
  const Estimate model = model_radius(rig);
  const double weight = model.variance / (model.variance + measured.variance);
  return {model.mean + weight * (measured.mean - model.mean), weight * measured.variance};
}

/// A position in the laser frame and its covariance xx xy yy.
struct Place {
  double x_m = 0.0, y_m = 0.0;
  std::array<double, 3> covariance{};
};

/// Centre without a circle: range to the bark plus radius, at the bearing of the visible middle.
Place by_range(const laser::Segment& segment, const laser::Scan& scan, bool is_trunk, bool hidden,
               const Rig& rig) {
  const Estimate radius = radius_of(segment, is_trunk, rig);
  const double c = std::cos(segment.bearing_rad), s = std::sin(segment.bearing_rad);
  const double range_m = segment.range_m + radius.mean;
  const double along_m2 =
      geometry::square(rig.laser.range_sd_at(segment.range_m)) / std::max(segment.num_beams, 1) +
      radius.variance;
  // Each side is uniform within one beam step, and the middle is the mean of both. With a hidden
  // side the visible middle may be off by half a trunk's width.
  double across_m2 = geometry::square(range_m * scan.bearing_step_rad) / 12.0;
  if (hidden) {
    across_m2 += geometry::square(0.5 * rig.detector.width.mean_m);
  }
  return {range_m * c,
          range_m * s,
          {c * c * along_m2 + s * s * across_m2, c * s * (along_m2 - across_m2),
           s * s * along_m2 + c * c * across_m2}};
}

/// Centre by the circle. For a trunk, a Kalman update with the model's radius corrects it.
Place by_circle(const laser::CircleFit& circle, bool is_trunk, const Rig& rig) {
  const auto& [xx, xy, yy, xr, yr, rr] = circle.covariance;
  if (!is_trunk) return {circle.x_m, circle.y_m, {xx, xy, yy}};
  const Estimate model = model_radius(rig);
  const double innovation_m = model.mean - circle.radius_m;
  const double total_m2 = rr + model.variance;
  const double gain_x = xr / total_m2, gain_y = yr / total_m2;
  return {circle.x_m + gain_x * innovation_m,
          circle.y_m + gain_y * innovation_m,
          {xx - gain_x * xr, xy - gain_x * yr, yy - gain_y * yr}};
}

}  // namespace

void place_in_base(Detection& detection, const laser::Segment& segment, const laser::Scan& scan,
                   bool is_trunk, const Rig& rig) {
  const laser::LaserConfig& mount = rig.laser;
  Place place = segment.circle ? by_circle(*segment.circle, is_trunk, rig)
                               : by_range(segment, scan, is_trunk, detection.occlusion != 0, rig);
  // The error common to all beams moves the centre along the line of sight.
  const double shared2 = geometry::square(mount.target_sd_fraction);
  auto& [xx, xy, yy] = place.covariance;
  xx += shared2 * geometry::square(place.x_m);
  xy += shared2 * place.x_m * place.y_m;
  yy += shared2 * geometry::square(place.y_m);

  const double c = std::cos(mount.mount_yaw_rad), s = std::sin(mount.mount_yaw_rad);
  detection.surface_x_m =
      mount.mount_x_m + segment.range_m * std::cos(mount.mount_yaw_rad + segment.bearing_rad);
  detection.surface_y_m =
      mount.mount_y_m + segment.range_m * std::sin(mount.mount_yaw_rad + segment.bearing_rad);
  detection.centre_x_m = mount.mount_x_m + c * place.x_m - s * place.y_m;
  detection.centre_y_m = mount.mount_y_m + s * place.x_m + c * place.y_m;
  detection.covariance = geometry::rotated_covariance(place.covariance, mount.mount_yaw_rad);
}

}  // namespace orchard::detection
