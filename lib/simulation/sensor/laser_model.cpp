// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/sensor/laser_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "simulation/sensor/ground_ray.hpp"

namespace orchard::simulation {
namespace {

constexpr int kNumRays = 9;              ///< across a spot; odd, so that the middle one is its axis
constexpr double kSameSurface_m = 0.10;  ///< max range difference of rays on one surface

/// Range measured by a spot: of the nearest surface that fills enough of it, or a mixture of two.
Hit read_spot(const Hit* rays, double mixed_draw, const ScannerConfig& scanner) {
  Hit nearest;
  for (int i = 0; i < kNumRays; ++i) {
    if (rays[i].range_m < nearest.range_m) nearest = rays[i];
  }
  if (nearest.range_m == kNoHit) return nearest;
  double near_sum_m = 0.0, far_sum_m = 0.0, near_strength = 0.0, far_strength = 0.0;
  int num_near = 0, num_far = 0, far_target = -1;
  for (int i = 0; i < kNumRays; ++i) {
    if (rays[i].range_m == kNoHit) continue;
    if (rays[i].range_m < nearest.range_m + kSameSurface_m) {
      near_sum_m += rays[i].range_m;
      near_strength += rays[i].strength;
      ++num_near;
    } else {
      far_sum_m += rays[i].range_m;
      far_strength += rays[i].strength;
      far_target = rays[i].target;
      ++num_far;
    }
  }
  const int fewest_rays =
      std::max(1, static_cast<int>(std::ceil(scanner.return_fraction * kNumRays)));
  const bool split = num_far > 0 && num_near > kNumRays / 4 && num_far > kNumRays / 4;
  if (split && mixed_draw < scanner.mixed_probability) {
    // A phase-shift scanner that sees two surfaces measures a range between them.
    return {(near_sum_m + far_sum_m) / (num_near + num_far), nearest.target,
            (near_strength + far_strength) / kNumRays};
  }
  if (num_near >= fewest_rays) {
    return {near_sum_m / num_near, nearest.target, near_strength / kNumRays};
  }
  if (num_far >= fewest_rays) return {far_sum_m / num_far, far_target, far_strength / kNumRays};
  return {};
}

/// Min strength of a hit that counts as a reflector.
constexpr double kShines = 2.0;
constexpr double kBloomFraction = 0.5;  ///< fraction of its strength in neighbouring beams

/// Blooming: beams near a reflector measure the reflector, unless they meet a nearer object.
void bloom(const ScannerConfig& scanner, std::vector<Hit>& hits) {
  const auto reach = static_cast<int>(std::floor(scanner.bloom_rad / scanner.bearing_step_rad));
  if (reach == 0) return;
  const std::vector<Hit> sharp = hits;
  for (int i = 0; i < scanner.num_beams; ++i) {
    const Hit& from = sharp[static_cast<std::size_t>(i)];
    if (from.range_m == kNoHit || from.strength < kShines) continue;
    for (int k = std::max(0, i - reach); k <= std::min(scanner.num_beams - 1, i + reach); ++k) {
      Hit& hit = hits[static_cast<std::size_t>(k)];
      if (from.range_m >= hit.range_m) continue;
      hit = from;
      hit.strength *= kBloomFraction;
    }
  }
}

constexpr double kGroundStrength = 0.05;  ///< grazing

/// Range at which a beam of a tilted scan plane meets level ground.
double ground_range_m(const ScannerConfig& scanner, const Tilt& tilt, int beam) {
  const double bearing_rad = scanner.bearing_min_rad + beam * scanner.bearing_step_rad;
  const double down =
      tilt.pitch_rad * std::cos(bearing_rad) - tilt.roll_rad * std::sin(bearing_rad);
  return down > 1e-6 ? scanner.height_m / std::sin(std::min(down, 1.5)) : kNoHit;
}

/// Intensity relative to a white sheet, times 1000; scanners compensate the loss with range.
float intensity_of(const Hit& hit, double noise) {
  constexpr double kNoise = 0.04;
  return static_cast<float>(
      std::round(std::max(1.0, 1000.0 * hit.strength * (1.0 + kNoise * noise))));
}

laser::Scan empty_scan(const ScannerConfig& scanner) {
  laser::Scan scan;
  scan.bearing_min_rad = scanner.bearing_min_rad;
  scan.bearing_step_rad = scanner.bearing_step_rad;
  scan.beam_period_us = scanner.beam_period_us;
  scan.range_min_m = scanner.range_min_m;
  scan.range_max_m = scanner.range_max_m;
  scan.ranges_m.assign(static_cast<std::size_t>(scanner.num_beams), 0.0f);
  return scan;
}

/// Range errors of all targets in one scan, as fractions of the range.
std::vector<double> draw_scan_errors(const World& world, const ScannerConfig& scanner,
                                     const std::vector<double>& target_errors, Random& random) {
  std::vector<double> errors(static_cast<std::size_t>(world.num_targets));
  const auto lasting = [&](std::size_t i) {
    return i < target_errors.size() ? target_errors[i] : 0.0;
  };
  constexpr int kManyTargets = 4096;
  if (world.num_targets <= kManyTargets) {
    for (std::size_t i = 0; i < errors.size(); ++i) {
      errors[i] = lasting(i) + random.normal(0.0, scanner.scan_sd_fraction);
    }
    return errors;
  }
  // Each target has its own random numbers, so the cost depends only on the targets in range.
  const std::uint64_t scan_bits = random.bits();
  const auto draw = [&](int target) {
    if (target < 0 || target >= world.num_targets) return;
    const auto i = static_cast<std::size_t>(target);
    errors[i] = lasting(i) +
                scanner.scan_sd_fraction * normal_of(mix_bits(scan_bits ^ mix_bits(2 * i)),
                                                     mix_bits(scan_bits ^ mix_bits(2 * i + 1)));
  };
  for (const Cylinder& cylinder : world.cylinders) draw(cylinder.target);
  for (const Box& box : world.boxes) draw(box.target);
  return errors;
}

/// Throws std::invalid_argument unless there is one pose, or one per beam.
void check_poses(std::size_t num_poses, const ScannerConfig& scanner) {
  if (num_poses != 1 && num_poses != static_cast<std::size_t>(scanner.num_beams)) {
    throw std::invalid_argument("simulate_scan: needs one pose, or one per beam");
  }
}

/// Reads the hits of a fan. `ground(beam, range_m)`: the hit of a beam on the ground, if any,
/// nearer than a range.
template <class Ground>
laser::Scan read_scan(const World& world, const RayFan& fan, const ScannerConfig& scanner,
                      const std::vector<double>& target_errors, Random& random,
                      const Ground& ground) {
  const std::vector<double> errors = draw_scan_errors(world, scanner, target_errors, random);

  laser::Scan scan = empty_scan(scanner);
  if (scanner.intensities) scan.intensities.assign(scan.ranges_m.size(), 0.0f);
  std::vector<Hit> hits;
  std::vector<std::array<double, 2>> draws;  // dropout and noise of each beam
  for (int i = 0; i < scanner.num_beams; ++i) {
    // Draw for every beam, hit or not: an additional target does not change the noise of the
    // others.
    const double mixed_draw = random.uniform();
    const double dropout_draw = random.uniform();
    draws.push_back({dropout_draw, random.normal()});
    hits.push_back(read_spot(fan.beam(i), mixed_draw, scanner));
  }
  bloom(scanner, hits);
  for (int i = 0; i < scanner.num_beams; ++i) {
    const auto [dropout_draw, noise] = draws[static_cast<std::size_t>(i)];
    Hit hit = hits[static_cast<std::size_t>(i)];
    const Hit below = ground(i, hit.range_m);
    if (below.range_m < hit.range_m) hit = below;
    if (hit.range_m == kNoHit || dropout_draw < scanner.dropout_probability) continue;
    const double of_target =
        hit.target >= 0 && hit.target < world.num_targets ? errors[hit.target] : 0.0;
    const double limit_m =
        hit.range_m < 1.0 ? scanner.limit_m : scanner.limit_fraction * hit.range_m;
    const double error_m = of_target * hit.range_m +
                           noise * (scanner.beam_sd_m + scanner.beam_sd_fraction * hit.range_m);
    const double range_m = hit.range_m + std::clamp(error_m, -limit_m, limit_m);
    if (range_m < scanner.range_min_m || range_m > scanner.range_max_m) continue;
    scan.ranges_m[i] =
        static_cast<float>(std::round(range_m / scanner.resolution_m) * scanner.resolution_m);
    if (scanner.intensities) scan.intensities[i] = intensity_of(hit, noise);
  }
  return scan;
}

}  // namespace

std::vector<double> draw_target_errors(int num_targets, const ScannerConfig& scanner,
                                       Random& random) {
  std::vector<double> errors(static_cast<std::size_t>(num_targets));
  for (double& error : errors) error = random.normal(0.0, scanner.target_sd_fraction);
  return errors;
}

laser::Scan simulate_scan(const World& world, const std::vector<Pose2>& T_map_laser,
                          const ScannerConfig& scanner, const std::vector<double>& target_errors,
                          Random& random, const Tilt& tilt) {
  check_poses(T_map_laser.size(), scanner);
  const bool leafy = std::any_of(world.cylinders.begin(), world.cylinders.end(),
                                 [](const Cylinder& c) { return c.leaf_depth_m > 0.0; });
  RayFan fan(T_map_laser, scanner, kNumRays, leafy ? random.bits() : 0);
  fan.add(world);
  return read_scan(world, fan, scanner, target_errors, random, [&](int beam, double) {
    return Hit{ground_range_m(scanner, tilt, beam), -1, kGroundStrength};
  });
}

laser::Scan simulate_scan(const World& world, const UnevenSweep& sweep,
                          const ScannerConfig& scanner, const std::vector<double>& target_errors,
                          Random& random) {
  check_poses(sweep.T_map_laser.size(), scanner);
  const std::uint64_t leaf_bits = random.bits(), grass_bits = random.bits();
  RayFan fan(sweep, scanner, kNumRays, leaf_bits);
  fan.add(world);
  return read_scan(world, fan, scanner, target_errors, random, [&](int beam, double range_m) {
    const double bearing_rad = scanner.bearing_min_rad + beam * scanner.bearing_step_rad;
    const auto i = sweep.T_map_laser.size() == 1 ? 0u : static_cast<std::size_t>(beam);
    const Eigen::Isometry3d& T_map_laser = sweep.T_map_laser[i];
    const Eigen::Vector3d from = T_map_laser.translation();
    const Eigen::Vector3d towards =
        T_map_laser.linear() * Eigen::Vector3d(std::cos(bearing_rad), std::sin(bearing_rad), 0.0);
    const std::uint64_t bits = mix_bits(grass_bits ^ static_cast<std::uint64_t>(beam));
    return meet_ground(sweep.terrain, sweep.grass_height_m, from, towards,
                       std::min(range_m, 1.1 * scanner.range_max_m),
                       static_cast<double>((bits >> 11) + 1) * 0x1p-53);
  });
}

laser::Scan simulate_perfect_scan(const World& world, const Pose2& T_map_laser,
                                  const ScannerConfig& scanner) {
  const std::vector<Pose2> poses{T_map_laser};
  RayFan fan(poses, scanner, 1);
  fan.add(world);
  laser::Scan scan = empty_scan(scanner);
  for (int i = 0; i < scanner.num_beams; ++i) {
    const double range_m = fan.beam(i)->range_m;
    if (range_m >= scanner.range_min_m && range_m <= scanner.range_max_m) {
      scan.ranges_m[i] = static_cast<float>(range_m);
    }
  }
  return scan;
}

}  // namespace orchard::simulation
