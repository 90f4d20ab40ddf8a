// SPDX-License-Identifier: BSD-3-Clause
#include "unit/pose/prior_map/prior_world.hpp"
#include "geometry/pose2.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "simulation/random.hpp"
#include "unit/pose/prior_map/noisy_trunk.hpp"

namespace orchard::pose {
using geometry::compose;
using geometry::inverse_transform;

namespace {

using simulation::Random;
using simulation::Stream;

constexpr double kStepM = 0.02;
constexpr double kOdometryPeriodS = 0.02;
constexpr int kOdometryPerScan = 5;
constexpr double kSweepS = 0.067;
constexpr double kCarryS = 5.0;

/// What a scan at T_map_base shows, in the order of its beams.
detection::Detections observe(const PriorWorld& world, const Eigen::Vector3d& T_map_base,
                              double yaw_rate_radps, double speed_mps,
                              const PriorDriveOptions& options, Random& noise) {
  struct Shape {
    double bearing_rad, half_rad, range_m, width_m;
  };
  std::vector<Shape> shapes;
  const auto consider = [&](const Eigen::Vector2d& p_map, double width_m) {
    // the beam reaches it when the sweep is so far round
    Eigen::Vector2d p_base = inverse_transform(T_map_base, p_map);
    const double early_rad = std::atan2(p_base.y(), p_base.x());
    const double dt_s = kSweepS * (early_rad / (2.0 * options.sight_half_angle_rad) + 0.5);
    const Eigen::Vector3d T_then =
        compose(T_map_base, {speed_mps * dt_s, 0.0, yaw_rate_radps * dt_s});
    p_base = inverse_transform(T_then, p_map);
    const double range_m = p_base.norm();
    const double bearing_rad = std::atan2(p_base.y(), p_base.x());
    if (range_m > options.sight_range_m || std::abs(bearing_rad) > options.sight_half_angle_rad) {
      return;
    }
    shapes.push_back(
        {bearing_rad, std::asin(std::min(1.0, 0.5 * width_m / range_m)), range_m, width_m});
  };
  for (const PriorLandmark& tree : world.trees) {
    if ((tree.p_map - T_map_base.head<2>()).norm() < options.sight_range_m + 1.0) {
      consider(tree.p_map, tree.width_m);
    }
  }
  if (noise.uniform() < options.false_per_scan) {
    const double range_m = noise.uniform(0.5, options.sight_range_m);
    const double bearing_rad =
        noise.uniform(-options.sight_half_angle_rad, options.sight_half_angle_rad);
    shapes.push_back({bearing_rad, 0.06 / range_m, range_m, noise.uniform(0.03, 0.2)});
  }
  std::sort(shapes.begin(), shapes.end(),
            [](const Shape& a, const Shape& b) { return a.bearing_rad < b.bearing_rad; });

  detection::Detections seen;
  for (const Shape& shape : shapes) {
    const bool hidden = std::any_of(shapes.begin(), shapes.end(), [&](const Shape& other) {
      return other.range_m < shape.range_m - 0.05 &&
             std::abs(other.bearing_rad - shape.bearing_rad) < other.half_rad + shape.half_rad;
    });
    const double num_beams = 2.0 * shape.half_rad / options.beam_step_rad;
    // three beams make an object; of fewer, some
    const double missed =
        std::max(options.miss_probability, std::min(1.0, 1.0 - 0.4 * (num_beams - 1.0)));
    if (hidden || noise.uniform() < missed) continue;
    const TrunkNoise sds{std::hypot(0.006, 0.006 * shape.range_m), 0.4 * options.beam_step_rad, 0.0,
                         0.5 * options.beam_step_rad};
    detection::Detection trunk =
        noisy_trunk({shape.range_m, shape.bearing_rad, shape.width_m}, sds, 0.01, noise);
    trunk.utime = std::llround(1e6 * kSweepS *
                               (shape.bearing_rad / (2.0 * options.sight_half_angle_rad) + 0.5));
    trunk.probability_tree = 0.9;
    trunk.roc_tree = 0.7;
    trunk.num_beams = static_cast<std::int32_t>(num_beams);
    seen.trunks.push_back(trunk);
  }
  return seen;
}

}  // namespace

PriorWorld prior_world(std::uint64_t seed, const PriorWorldOptions& options) {
  Random random(seed, Stream::kScene);
  PriorWorld world;
  world.num_rows = options.num_rows;
  world.row_spacing_m = options.row_spacing_m;
  world.length_m = (options.trees_per_row - 1) * options.tree_spacing_m;
  for (int row = 0; row < options.num_rows; ++row) {
    for (int i = 0; i < options.trees_per_row; ++i) {
      PriorLandmark tree;
      tree.p_map << i * options.tree_spacing_m + random.normal(0.0, options.jitter_m),
          row * options.row_spacing_m + random.normal(0.0, options.jitter_m);
      tree.width_m = std::max(0.05, random.normal(options.width_m, options.width_sd_m));
      if (random.uniform() >= options.missing_fraction) world.trees.push_back(tree);
    }
  }
  return world;
}

std::vector<PriorLandmark> mapped(const PriorWorld& world, std::uint64_t seed, double sd_m,
                                  double width_sd_m) {
  Random random(seed, Stream::kBench, 1);
  std::vector<PriorLandmark> landmarks = world.trees;
  for (PriorLandmark& l : landmarks) {
    l.p_map.x() += random.normal(0.0, sd_m);
    l.p_map.y() += random.normal(0.0, sd_m);
    l.width_m = std::max(0.03, l.width_m + random.normal(0.0, width_sd_m));
  }
  return landmarks;
}

PriorWorld changed(const PriorWorld& world, std::uint64_t seed, double fraction) {
  Random random(seed, Stream::kBench, 2);
  PriorWorld later = world;
  later.trees.clear();
  for (const PriorLandmark& tree : world.trees) {
    if (random.uniform() >= fraction) {
      later.trees.push_back(tree);
      continue;
    }
    PriorLandmark fresh;  // in some row, anywhere along it
    const auto row = static_cast<double>(random.bits() % static_cast<unsigned>(world.num_rows));
    fresh.p_map << random.uniform(0.0, world.length_m),
        row * world.row_spacing_m + random.normal(0.0, 0.15);
    fresh.width_m = random.uniform(0.05, 0.15);
    later.trees.push_back(fresh);
  }
  return later;
}

std::vector<Eigen::Vector3d> way_through(const PriorWorld& world, double headland_m) {
  std::vector<Eigen::Vector3d> way;
  const double radius_m = 0.5 * world.row_spacing_m;
  for (int alley = 0; alley + 1 < world.num_rows; ++alley) {
    const double y_m = (alley + 0.5) * world.row_spacing_m;
    const bool up = alley % 2 == 0;
    const double straight_m = world.length_m + 2.0 * headland_m;
    for (double s_m = 0.0; s_m < straight_m; s_m += kStepM) {
      const double x_m = up ? s_m - headland_m : world.length_m + headland_m - s_m;
      way.emplace_back(x_m, y_m, up ? 0.0 : geometry::kPi);
    }
    if (alley + 2 >= world.num_rows) break;
    for (double s_m = 0.0; s_m < geometry::kPi * radius_m; s_m += kStepM) {
      const double turned_rad = s_m / radius_m;
      const double along_m = radius_m * std::sin(turned_rad);
      const double x_m = up ? world.length_m + headland_m + along_m : -headland_m - along_m;
      way.emplace_back(x_m, y_m + radius_m * (1.0 - std::cos(turned_rad)),
                       geometry::wrap_angle_rad(up ? turned_rad : geometry::kPi - turned_rad));
    }
  }
  return way;
}

void drive(const PriorWorld& world, const std::vector<Eigen::Vector3d>& way,
           const std::vector<Stretch>& stretches, std::uint64_t seed,
           const PriorDriveOptions& options,
           const std::function<bool(const Measurement&, const Eigen::Vector3d&, double)>& told) {
  Random run(seed, Stream::kOdometryRun);
  Random wheels(seed, Stream::kOdometry);
  Random scans(seed, Stream::kScan);
  const double speed_scale = run.normal(0.0, options.speed_scale_sd);
  const double turn_scale = run.normal(0.0, options.turn_scale_sd);
  const double bias_radps = run.normal(0.0, options.yaw_rate_bias_sd_radps);

  const auto pose_at = [&way](double s_m, bool backwards) {
    const auto i = std::min(way.size() - 1, static_cast<std::size_t>(std::max(0.0, s_m / kStepM)));
    Eigen::Vector3d T = way[i];
    if (backwards) T.z() = geometry::wrap_angle_rad(T.z() + geometry::kPi);
    return T;
  };
  std::int64_t utime = 1'000'000;
  std::int32_t seq = 0;
  double driven_m = 0.0;
  const auto tell = [&](const Eigen::Vector3d& T, double speed_mps, double yaw_rate_radps) {
    const double t_s = static_cast<double>(utime) * 1e-6;
    if (t_s < options.silent_from_s || t_s > options.silent_to_s) {
      Odometry odometry;
      odometry.utime = utime;
      odometry.seq = seq;
      odometry.speed_mps = speed_mps * (1.0 + speed_scale) + wheels.normal(0.0, 0.01);
      odometry.yaw_rate_radps =
          yaw_rate_radps * (1.0 + turn_scale) + bias_radps + wheels.normal(0.0, 0.01);
      const double scale_sd_mps = options.speed_scale_sd * speed_mps;
      odometry.covariance = {0.01 * 0.01 + scale_sd_mps * scale_sd_mps, 0.0, 0.01 * 0.01};
      if (!told(odometry, T, driven_m)) return false;
    }
    if (seq++ % kOdometryPerScan != 0) return true;
    detection::Detections seen = observe(world, T, yaw_rate_radps, speed_mps, options, scans);
    seen.utime = utime;
    seen.seq = seq / kOdometryPerScan;
    for (detection::Detection& trunk : seen.trunks) trunk.utime += utime;
    return told(seen, T, driven_m);
  };

  const double step_m = options.speed_mps * kOdometryPeriodS;
  const auto period_us = static_cast<std::int64_t>(std::llround(1e6 * kOdometryPeriodS));
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    const bool backwards = stretches[i].to_m < stretches[i].from_m;
    const double length_m = std::abs(stretches[i].to_m - stretches[i].from_m);
    Eigen::Vector3d before = pose_at(stretches[i].from_m, backwards);
    for (double s_m = 0.0; s_m < length_m; s_m += step_m) {
      const Eigen::Vector3d T = pose_at(stretches[i].from_m + (backwards ? -s_m : s_m), backwards);
      const double yaw_rate_radps = geometry::wrap_angle_rad(T.z() - before.z()) / kOdometryPeriodS;
      before = T;
      if (!tell(T, options.speed_mps, yaw_rate_radps)) return;
      utime += period_us;
      driven_m += step_m;
    }
    if (i + 1 == stretches.size()) break;
    // carried with the scanner switched off: only what it sees at the new place can tell
    for (double t_s = 0.0; t_s < kCarryS; t_s += kOdometryPeriodS) {
      Odometry standing;
      standing.utime = utime;
      standing.seq = seq++;
      standing.covariance = {1e-6, 0.0, 1e-6};
      if (!told(standing, before, driven_m)) return;
      utime += period_us;
    }
  }
}

}  // namespace orchard::pose
