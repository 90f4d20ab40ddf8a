// SPDX-License-Identifier: BSD-3-Clause
#include "detection/centre.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::detection {
namespace {

double square(double x) { return x * x; }

struct Diameter {
  double mean_m = 0.0;
  double variance_m2 = 0.0;
};

Diameter diameter_of(const laser::Segment& segment, bool is_trunk, const Rig& rig) {
  const Diameter measured{segment.width_m, square(std::max(segment.width_sd_m, 1e-4))};
  if (!is_trunk) return measured;
  const laser::WidthConfig& trunks = rig.detector.width;
  const double prior_variance_m2 = square(std::max(trunks.sd_m, trunks.sd_floor_m));
  const double weight = prior_variance_m2 / (prior_variance_m2 + measured.variance_m2);
  return {trunks.mean_m + weight * (measured.mean_m - trunks.mean_m),
          weight * measured.variance_m2};
}

}  // namespace

void place_in_base(Detection& detection, const laser::Segment& segment, const laser::Scan& scan,
                   bool is_trunk, const Rig& rig) {
  const laser::LaserConfig& mount = rig.laser;
  const double bearing_base_rad = mount.mount_yaw_rad + segment.bearing_rad;
  const double c = std::cos(bearing_base_rad), s = std::sin(bearing_base_rad);
  const Diameter diameter = diameter_of(segment, is_trunk, rig);
  const double centre_range_m = segment.range_m + 0.5 * diameter.mean_m;
  detection.surface_x_m = mount.mount_x_m + segment.range_m * c;
  detection.surface_y_m = mount.mount_y_m + segment.range_m * s;
  detection.centre_x_m = mount.mount_x_m + centre_range_m * c;
  detection.centre_y_m = mount.mount_y_m + centre_range_m * s;

  const double along_m2 =
      (square(mount.range_sd_m) + square(mount.range_sd_fraction * segment.range_m)) /
          std::max(segment.num_beams, 1) +
      0.25 * diameter.variance_m2;
  // Each side of an object may lie anywhere within one beam step; the middle is their mean. A
  // hidden side may lie anywhere within the trunk.
  double across_m2 = square(centre_range_m * scan.bearing_step_rad) / 12.0;
  if (detection.occlusion != 0) across_m2 += square(0.5 * rig.detector.width.mean_m);
  detection.covariance = {c * c * along_m2 + s * s * across_m2, c * s * (along_m2 - across_m2),
                          s * s * along_m2 + c * c * across_m2};
}

}  // namespace orchard::detection
