// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/sensor/laser_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "geometry/angles.hpp"

namespace orchard::simulation {
namespace {

constexpr int kNumRays = 9;  ///< across a spot; odd, so that the middle one is its axis
constexpr double kNoHit = std::numeric_limits<double>::infinity();
constexpr double kSameSurface_m = 0.10;  ///< max range difference of rays on one surface

struct Hit {
  double range_m = kNoHit;
  int target = -1;
  double strength = 0.0;  ///< reflectivity times the cosine of incidence
};

/// Distance along a ray to a circle's near side, or kNoHit. Ray and circle are in one frame.
double ray_circle(double dx, double dy, double cx, double cy, double radius_m) {
  const double along_m = cx * dx + cy * dy;
  const double across_m = cx * dy - cy * dx;
  const double inside = radius_m * radius_m - across_m * across_m;
  if (inside < 0.0 || along_m <= 0.0) return kNoHit;
  const double range_m = along_m - std::sqrt(inside);
  return range_m > 0.0 ? range_m : kNoHit;
}

/// Range at which a ray enters a box, and the cosine of incidence. Ray and box are in one frame.
struct BoxHit {
  double range_m = kNoHit;
  double cosine = 0.0;
};

BoxHit ray_box(double dx, double dy, double cx, double cy, const Box& box) {
  // Slab method in the box's own axes.
  const double c = std::cos(box.yaw_rad), s = std::sin(box.yaw_rad);
  const std::array<double, 2> towards{c * dx + s * dy, -s * dx + c * dy};
  const std::array<double, 2> from{-(c * cx + s * cy), -(-s * cx + c * cy)};
  const std::array<double, 2> half{0.5 * box.length_m, 0.5 * box.width_m};
  double enter_m = 0.0, leave_m = kNoHit, cosine = 0.0;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (std::abs(towards[axis]) < 1e-12) {
      if (std::abs(from[axis]) > half[axis]) return {};
      continue;
    }
    const double one_m = (-half[axis] - from[axis]) / towards[axis];
    const double other_m = (half[axis] - from[axis]) / towards[axis];
    if (std::min(one_m, other_m) > enter_m) {
      enter_m = std::min(one_m, other_m);
      cosine = std::abs(towards[axis]);
    }
    leave_m = std::min(leave_m, std::max(one_m, other_m));
  }
  return enter_m > 0.0 && enter_m < leave_m ? BoxHit{enter_m, cosine} : BoxHit{};
}

/// The first hit of every ray of every beam.
class RayFan {
 public:
  /// `leaf_bits`: random bits for the penetration of beams into leaves.
  RayFan(const std::vector<Pose2>& T_map_laser, const ScannerConfig& scanner, int num_rays,
         std::uint64_t leaf_bits = 0)
      : poses_(T_map_laser),
        scanner_(scanner),
        num_rays_(num_rays),
        leaf_bits_(leaf_bits),
        hits_(static_cast<std::size_t>(scanner.num_beams) * num_rays) {
    middle_ = poses_[poses_.size() / 2];
    for (const Pose2& pose : poses_) {
      moved_m_ = std::max(moved_m_, std::hypot(pose.x_m - middle_.x_m, pose.y_m - middle_.y_m));
      turned_rad_ =
          std::max(turned_rad_, std::abs(geometry::wrap_angle_rad(pose.yaw_rad - middle_.yaw_rad)));
    }
  }

  void add(const Cylinder& cylinder) {
    const double z_m = scanner_.height_m;
    if (z_m < cylinder.base_m || z_m > cylinder.base_m + cylinder.height_m) return;
    const bool moves = cylinder.velocity_x_mps != 0.0 || cylinder.velocity_y_mps != 0.0;
    const double way_m =
        moves ? std::hypot(cylinder.velocity_x_mps, cylinder.velocity_y_mps) * std::abs(time_s(0))
              : 0.0;
    for_each_beam(cylinder.x_m, cylinder.y_m, cylinder.radius_m + way_m,
                  [&](int beam) { cast(cylinder, beam); });
  }

  void add(const Box& box) {
    const double z_m = scanner_.height_m;
    if (z_m < box.base_m || z_m > box.base_m + box.height_m) return;
    for_each_beam(box.x_m, box.y_m, 0.5 * std::hypot(box.length_m, box.width_m),
                  [&](int beam) { cast(box, beam); });
  }

  const Hit* beam(int index) const { return &hits_[static_cast<std::size_t>(index) * num_rays_]; }

 private:
  /// Calls `function` for every beam that may meet a circle.
  template <class Function>
  void for_each_beam(double x_m, double y_m, double radius_m, const Function& function) {
    const double dx = x_m - middle_.x_m, dy = y_m - middle_.y_m;
    const double distance_m = std::hypot(dx, dy);
    const double clear_m = distance_m - radius_m - moved_m_;
    if (clear_m > scanner_.range_max_m * 1.1) return;
    double half_rad = geometry::kPi;
    if (clear_m > 1e-3) {
      half_rad = std::asin(std::min(1.0, radius_m / distance_m)) + turned_rad_ +
                 std::asin(std::min(1.0, moved_m_ / distance_m)) + 0.5 * scanner_.spot_rad +
                 std::asin(std::min(1.0, 0.5 * scanner_.spot_m / distance_m));
    }
    const double bearing_rad = std::atan2(dy, dx) - middle_.yaw_rad;
    const double step = scanner_.bearing_step_rad;
    // Try each direction in several turns: scanners of 360 degrees may begin anywhere.
    for (int turn = -2; turn <= 2; ++turn) {
      const double centre = (geometry::wrap_angle_rad(bearing_rad) + 2.0 * geometry::kPi * turn -
                             scanner_.bearing_min_rad) /
                            step;
      const double first = std::max(0.0, std::ceil(centre - half_rad / step));
      const double last = std::min(scanner_.num_beams - 1.0, std::floor(centre + half_rad / step));
      for (int beam = static_cast<int>(first); beam <= static_cast<int>(last); ++beam) {
        function(beam);
      }
    }
  }

  /// Time of a beam relative to the middle of the sweep.
  double time_s(int beam) const {
    return (beam - scanner_.num_beams / 2) * scanner_.beam_period_us * 1e-6;
  }

  /// A ray of a beam's spot: the rays start side by side and diverge.
  struct Ray {
    double dx = 1.0, dy = 0.0;    ///< direction in map
    double x_m = 0.0, y_m = 0.0;  ///< start point, in map
  };

  Ray ray_of(const Pose2& pose, int beam, int ray) const {
    const double axis_rad =
        pose.yaw_rad + scanner_.bearing_min_rad + beam * scanner_.bearing_step_rad;
    const double offset = num_rays_ == 1 ? 0.0 : (ray + 0.5) / num_rays_ - 0.5;
    const double angle_rad = axis_rad + offset * scanner_.spot_rad;
    const double aside_m = offset * scanner_.spot_m;
    return {std::cos(angle_rad), std::sin(angle_rad), pose.x_m - aside_m * std::sin(axis_rad),
            pose.y_m + aside_m * std::cos(axis_rad)};
  }

  const Pose2& pose_of(int beam) const { return poses_.size() == 1 ? poses_[0] : poses_[beam]; }
  Hit& hit_of(int beam, int ray) { return hits_[static_cast<std::size_t>(beam) * num_rays_ + ray]; }

  /// Penetration depth of a beam into leaves: exponentially distributed (Beer-Lambert).
  double leaf_depth_m(const Cylinder& cylinder, int beam) const {
    const auto which = static_cast<std::uint64_t>(cylinder.target) << 32;
    const std::uint64_t bits = mix_bits(leaf_bits_ ^ which ^ static_cast<std::uint64_t>(beam));
    const double uniform = static_cast<double>((bits >> 11) + 1) * 0x1p-53;
    return -cylinder.leaf_depth_m * std::log(uniform);
  }

  void cast(const Cylinder& cylinder, int beam) {
    const Pose2& pose = pose_of(beam);
    double x_m = cylinder.x_m, y_m = cylinder.y_m;
    if (cylinder.velocity_x_mps != 0.0 || cylinder.velocity_y_mps != 0.0) {
      x_m += cylinder.velocity_x_mps * time_s(beam);
      y_m += cylinder.velocity_y_mps * time_s(beam);
    }
    for (int ray = 0; ray < num_rays_; ++ray) {
      const Ray r = ray_of(pose, beam, ray);
      const double dx = r.dx, dy = r.dy, cx = x_m - r.x_m, cy = y_m - r.y_m;
      double range_m = ray_circle(dx, dy, cx, cy, cylinder.radius_m);
      if (cylinder.leaf_depth_m > 0.0 && range_m != kNoHit) {
        const double out_m = 2.0 * (cx * dx + cy * dy) - range_m;
        range_m += leaf_depth_m(cylinder, beam);
        if (range_m > out_m) continue;
      }
      Hit& hit = hit_of(beam, ray);
      if (!(range_m < hit.range_m)) continue;
      const double cosine =
          ((cx - range_m * dx) * dx + (cy - range_m * dy) * dy) / cylinder.radius_m;
      hit = {range_m, cylinder.target, cylinder.appearance.reflectivity * std::abs(cosine)};
    }
  }

  void cast(const Box& box, int beam) {
    const Pose2& pose = pose_of(beam);
    for (int ray = 0; ray < num_rays_; ++ray) {
      const Ray r = ray_of(pose, beam, ray);
      const BoxHit entered = ray_box(r.dx, r.dy, box.x_m - r.x_m, box.y_m - r.y_m, box);
      Hit& hit = hit_of(beam, ray);
      if (entered.range_m < hit.range_m) {
        hit = {entered.range_m, box.target, box.appearance.reflectivity * entered.cosine};
      }
    }
  }

  const std::vector<Pose2>& poses_;
  const ScannerConfig& scanner_;
  int num_rays_;
  std::uint64_t leaf_bits_;
  std::vector<Hit> hits_;
  Pose2 middle_;
  double moved_m_ = 0.0;
  double turned_rad_ = 0.0;
};

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
  if (T_map_laser.size() != 1 &&
      T_map_laser.size() != static_cast<std::size_t>(scanner.num_beams)) {
    throw std::invalid_argument("simulate_scan: needs one pose, or one per beam");
  }
  const bool leafy = std::any_of(world.cylinders.begin(), world.cylinders.end(),
                                 [](const Cylinder& c) { return c.leaf_depth_m > 0.0; });
  RayFan fan(T_map_laser, scanner, kNumRays, leafy ? random.bits() : 0);
  for (const Cylinder& cylinder : world.cylinders) fan.add(cylinder);
  for (const Box& box : world.boxes) fan.add(box);

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
    const double ground_m = ground_range_m(scanner, tilt, i);
    if (ground_m < hit.range_m) hit = {ground_m, -1, kGroundStrength};
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

laser::Scan simulate_perfect_scan(const World& world, const Pose2& T_map_laser,
                                  const ScannerConfig& scanner) {
  const std::vector<Pose2> poses{T_map_laser};
  RayFan fan(poses, scanner, 1);
  for (const Cylinder& cylinder : world.cylinders) fan.add(cylinder);
  for (const Box& box : world.boxes) fan.add(box);
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
