// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "laser/laser_config.hpp"
#include "laser/scan.hpp"

namespace orchard::laser::test {

constexpr double kPi = 3.14159265358979323846;

struct Disc {
  double x_m, y_m, radius_m;
};

/// A straight wall from a to b.
struct Wall {
  double ax_m, ay_m, bx_m, by_m;
};

/// What stands around the scanner, in its frame.
struct Things {
  std::vector<Disc> discs;
  std::vector<Wall> walls;
};

/// How a scanner sees: the noise of one range and the width of its spot.
struct Scanner {
  double step_rad;
  int num_beams;
  double range_sd_m = 0.0;
  double range_sd_fraction = 0.0;
  double range_max_m = 30.0;

  Scan empty() const {
    Scan scan;
    scan.bearing_step_rad = step_rad;
    scan.bearing_min_rad = -0.5 * (num_beams - 1) * step_rad;
    scan.range_min_m = 0.02;
    scan.range_max_m = range_max_m;
    scan.ranges_m.assign(static_cast<std::size_t>(num_beams), 0.0f);
    return scan;
  }
};

inline Scanner urg() { return {2.0 * kPi / 1024.0, 683, 0.003, 0.003}; }
inline Scanner field_scanner() { return {0.25 * kPi / 180.0, 1081, 0.008, 0.0}; }
inline Scanner vlp16_slice() { return {2.0 * kPi / 897.0, 897, 0.010, 0.0}; }

/// Seeded normal numbers, the same everywhere: splitmix64 and Box-Muller.
class Noise {
 public:
  explicit Noise(std::uint64_t seed) : state_(seed * 0x9E3779B97F4A7C15u + 1) {}
  double uniform() {
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15u);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1.0p-53;
  }
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * kPi * uniform());
  }

 private:
  std::uint64_t state_;
};

/// Exact first hit of one ray, or infinity.
inline double hit_m(const Things& things, double bearing_rad) {
  const double c = std::cos(bearing_rad), s = std::sin(bearing_rad);
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const Disc& d : things.discs) {
    const double along_m = d.x_m * c + d.y_m * s;
    const double across_m = d.y_m * c - d.x_m * s;
    if (along_m <= 0.0 || std::abs(across_m) >= d.radius_m) continue;
    nearest_m =
        std::min(nearest_m, along_m - std::sqrt(d.radius_m * d.radius_m - across_m * across_m));
  }
  for (const Wall& w : things.walls) {
    // a + t (b - a) = r (c, s)
    const double dx = w.bx_m - w.ax_m, dy = w.by_m - w.ay_m;
    const double determinant = c * dy - s * dx;
    if (std::abs(determinant) < 1e-12) continue;
    const double r_m = (w.ax_m * dy - w.ay_m * dx) / determinant;
    const double t =
        std::abs(dx) > std::abs(dy) ? (r_m * c - w.ax_m) / dx : (r_m * s - w.ay_m) / dy;
    if (r_m > 0.0 && t >= 0.0 && t <= 1.0) nearest_m = std::min(nearest_m, r_m);
  }
  return nearest_m;
}

/// The scan of an ideal scanner: each beam a line, no noise.
inline Scan exact_scan(const Things& things, const Scanner& scanner) {
  Scan scan = scanner.empty();
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double range_m = hit_m(things, scan.bearing_rad(static_cast<double>(i)));
    if (range_m <= scanner.range_max_m) scan.ranges_m[i] = static_cast<float>(range_m);
  }
  return scan;
}

/// The same with noise on every range.
inline Scan noisy_scan(const Things& things, const Scanner& scanner, Noise& noise) {
  Scan scan = scanner.empty();
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double draw = noise.normal();
    const double range_m = hit_m(things, scan.bearing_rad(static_cast<double>(i)));
    if (range_m > scanner.range_max_m) continue;
    const double sd_m = std::hypot(scanner.range_sd_m, scanner.range_sd_fraction * range_m);
    scan.ranges_m[i] = static_cast<float>(range_m + sd_m * draw);
  }
  return scan;
}

/// The range noise that a rig with this scanner states.
inline LaserConfig noise_of(const Scanner& scanner) {
  LaserConfig laser;
  laser.range_sd_m = std::max(scanner.range_sd_m, 0.003);
  laser.range_sd_fraction = scanner.range_sd_fraction;
  return laser;
}

/// A wall nearer than everything that hides what lies left of a bearing.
inline Wall screen(double range_m, double from_rad, double to_rad) {
  return {range_m * std::cos(from_rad), range_m * std::sin(from_rad), range_m * std::cos(to_rad),
          range_m * std::sin(to_rad)};
}

}  // namespace orchard::laser::test
