// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/extrinsics/mean_scan.hpp"

#include <cmath>
#include <stdexcept>

#include "geometry/statistics.hpp"

namespace orchard::calibration {
namespace {

/// Max deviation from the median range; well above the noise of a beam.
double near_m(double range_m) { return 0.03 + 0.03 * range_m; }

}  // namespace

laser::Scan mean_scan(const std::vector<laser::Scan>& scans) {
  if (scans.empty()) throw std::invalid_argument("mean_scan: no scan");
  laser::Scan mean = scans[scans.size() / 2];
  if (scans.size() == 1) return mean;
  for (const laser::Scan& scan : scans) {
    if (scan.ranges_m.size() != mean.ranges_m.size() ||
        scan.bearing_min_rad != mean.bearing_min_rad ||
        scan.bearing_step_rad != mean.bearing_step_rad) {
      throw std::invalid_argument("mean_scan: scans of different shapes");
    }
  }
  mean.intensities.clear();
  std::vector<double> ranges_m;
  for (std::size_t i = 0; i < mean.ranges_m.size(); ++i) {
    ranges_m.clear();
    for (const laser::Scan& scan : scans) {
      if (scan.valid(i)) ranges_m.push_back(scan.ranges_m[i]);
    }
    if (2 * ranges_m.size() <= scans.size()) {
      mean.ranges_m[i] = 0.0f;
      continue;
    }
    const double middle_m = geometry::median(ranges_m);
    double sum_m = 0.0;
    int num = 0;
    for (const double range_m : ranges_m) {
      if (std::abs(range_m - middle_m) > near_m(middle_m)) continue;
      sum_m += range_m;
      ++num;
    }
    mean.ranges_m[i] = static_cast<float>(sum_m / num);
  }
  return mean;
}

}  // namespace orchard::calibration
