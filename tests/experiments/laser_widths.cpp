// SPDX-License-Identifier: BSD-3-Clause
// How well widths and centres are measured: the angle a trunk fills and its mean range, against a
// circle through its arc. Exact rays, seeded noise. laser_widths SEEDS FIRST.
#include <algorithm>
#include <cstdlib>

#include "experiments/json_line.hpp"
#include "laser/segment.hpp"
#include "unit/laser/exact_scan.hpp"

namespace {

using namespace orchard::laser;
using namespace orchard::laser::test;

struct Sums {
  int n = 0, in95 = 0;
  double width2 = 0.0, along2 = 0.0, across2 = 0.0;
};

void row(const std::string& name, const Scanner& scanner, double diameter_m, double range_m,
         int num_seeds, int first_seed) {
  Sums angle, circle;
  for (int seed = first_seed; seed < first_seed + num_seeds; ++seed) {
    Noise noise(static_cast<std::uint64_t>(seed));
    const double bearing_rad = 2.0 * (noise.uniform() - 0.5);
    const double radius_m = 0.5 * diameter_m, centre_m = range_m + radius_m;
    const double c = std::cos(bearing_rad), s = std::sin(bearing_rad);
    const Things things{{{centre_m * c, centre_m * s, radius_m}}, {}};
    SegmentationConfig config;
    config.range_max_m = 30.0;
    config.min_beams_circle = 3;
    LaserConfig laser;
    laser.range_sd_m = scanner.range_sd_m;
    laser.range_sd_fraction = scanner.range_sd_fraction;
    const Segment* found = nullptr;
    const auto segments = segment(noisy_scan(things, scanner, noise), config, {}, laser);
    for (const Segment& x : segments) {
      if (x.range_m > 0.8 * range_m) found = &x;
    }
    if (!found) continue;
    const auto add = [&](Sums& sums, double x_m, double y_m, double width_m, double z2) {
      const double along_m = c * x_m + s * y_m - centre_m, across_m = c * y_m - s * x_m;
      ++sums.n;
      sums.width2 += (width_m - diameter_m) * (width_m - diameter_m);
      sums.along2 += along_m * along_m;
      sums.across2 += across_m * across_m;
      sums.in95 += z2 < 5.991;
    };
    const double r_m = found->range_m + 0.5 * found->width_m;
    add(angle, r_m * std::cos(found->bearing_rad), r_m * std::sin(found->bearing_rad),
        found->width_m, 0.0);
    if (found->circle) {
      const CircleFit& f = *found->circle;
      const double dx = f.x_m - centre_m * c, dy = f.y_m - centre_m * s;
      const double xx = f.covariance[0], xy = f.covariance[1], yy = f.covariance[2];
      const double z2 = (dx * dx * yy - 2.0 * dx * dy * xy + dy * dy * xx) / (xx * yy - xy * xy);
      add(circle, f.x_m, f.y_m, 2.0 * f.radius_m, z2);
    }
  }
  const auto rms_mm = [](double sum2, int n) { return 1e3 * std::sqrt(sum2 / std::max(n, 1)); };
  orchard::trials::print_json({{"scanner", name},
                               {"diameter_m", diameter_m},
                               {"range_m", range_m},
                               {"angle_width_mm", rms_mm(angle.width2, angle.n)},
                               {"angle_across_mm", rms_mm(angle.across2, angle.n)},
                               {"circle_width_mm", rms_mm(circle.width2, circle.n)},
                               {"circle_along_mm", rms_mm(circle.along2, circle.n)},
                               {"circle_across_mm", rms_mm(circle.across2, circle.n)},
                               {"in_95", 1.0 * circle.in95 / std::max(circle.n, 1)},
                               {"circle_fitted", 1.0 * circle.n / num_seeds}});
}

}  // namespace

int main(int argc, char** argv) {
  const int num_seeds = argc > 1 ? std::atoi(argv[1]) : 400;
  const int first_seed = argc > 2 ? std::atoi(argv[2]) : 5001;
  const struct {
    const char* name;
    Scanner scanner;
  } kScanners[] = {{"urg", urg()}, {"field", field_scanner()}, {"vlp16", vlp16_slice()}};
  for (const auto& k : kScanners) {
    for (const double diameter_m : {0.090, 0.125, 0.230}) {
      for (const double range_m : {0.5, 1.0, 2.0, 3.0, 4.0, 6.0}) {
        row(k.name, k.scanner, diameter_m, range_m, num_seeds, first_seed);
      }
    }
  }
}
