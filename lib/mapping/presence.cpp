// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/presence.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

/// A landmark tells by its number of observations whether a scan's pose can be trusted, up to
/// these.
constexpr int kWitnessMost = 100;
/// A miss from a side on which the thing was never seen counts as this much of one.
constexpr double kUnseenSide = 0.25;
/// Something seen this near to a place beyond its own half width may be what stands there.
constexpr double kBeside_m = 0.3;
constexpr int kNumSides = 8;

/// The side of a landmark that one looks at, of kNumSides.
int side_of(const Vector2d& from_landmark) {
  const double turns = std::atan2(from_landmark.y(), from_landmark.x()) / (2.0 * geometry::kPi);
  return std::min(kNumSides - 1, static_cast<int>((turns + 0.5) * kNumSides));
}

std::uint8_t bit(int side) {
  return static_cast<std::uint8_t>(1u << ((side + kNumSides) % kNumSides));
}

struct Miss {
  std::int32_t index = 0;
  double weight = 1.0;
};

}  // namespace

std::vector<std::int32_t> PresenceWatch::review(const std::vector<Candidate>& candidates,
                                                const std::vector<std::int32_t>& observed,
                                                const pose::PoseEstimate& T_map_base,
                                                LandmarkTable& landmarks) {
  if (!config_.enabled) return {};
  const Vector2d base_map(T_map_base.x_m, T_map_base.y_m);
  const Eigen::Rotation2Dd R_map_base(T_map_base.yaw_rad);
  const Vector2d laser_map = base_map + R_map_base * p_base_laser_;
  const auto to_laser = [&](const Vector2d& p_map) {
    return Vector2d(R_map_base.inverse() * (p_map - laser_map));
  };

  const double for_it = std::log(config_.seen_rate / config_.stray_rate);
  for (const std::int32_t i : observed) {
    landmarks.change(i, [&](LandmarkRecord& r) {
      r.presence = static_cast<float>(std::min(config_.log_odds_max, r.presence + for_it));
      r.sides_seen |= bit(side_of(laser_map - r.anchor()));
    });
  }

  const auto period_us = static_cast<std::int64_t>(1e6 * config_.period_s);
  const std::int64_t since_us = last_utime_ ? T_map_base.utime - *last_utime_ : period_us;
  if (since_us >= 0 && since_us < period_us) return {};
  last_utime_ = T_map_base.utime;

  std::vector<pose::Sighting> sightings;
  for (const Candidate& c : candidates) {
    pose::Sighting s;
    s.p_base = to_laser(c.p_aligned);
    s.width_m = c.detection->width_m;
    sightings.push_back(s);
  }
  sight_.learn(sightings);
  if (observed.empty()) return {};
  const pose::Shadows shadows(sightings);
  const auto is_something_at = [&](const Vector2d& p_map) {
    return std::any_of(candidates.begin(), candidates.end(), [&](const Candidate& c) {
      const double beside_m = kBeside_m + 0.5 * c.detection->width_m;
      return (c.p_aligned - p_map).squaredNorm() < beside_m * beside_m;
    });
  };
  const std::int32_t scan = landmarks[observed.front()].last_scan;
  std::vector<Miss> misses;
  int for_pose = 0, against_pose = 0;
  for (const std::int32_t i : observed) {
    if (!sight_.covers(to_laser(landmarks[i].anchor()))) continue;
    for_pose += std::min(landmarks[i].num_all, kWitnessMost);
  }
  landmarks.near(laser_map, sight_.range_m(), [&](std::int32_t i, const LandmarkRecord& r) {
    if (r.last_scan == scan) return;
    const Vector2d p = to_laser(r.anchor());
    if (!sight_.covers(p) || shadows.hide(p) || is_something_at(r.anchor())) return;
    const int side = side_of(laser_map - r.anchor());
    const bool is_known_side = (r.sides_seen & (bit(side - 1) | bit(side) | bit(side + 1))) != 0;
    misses.push_back({i, is_known_side ? 1.0 : kUnseenSide});
    against_pose += std::min(r.num_all, kWitnessMost);
  });
  if (against_pose > for_pose) return {};

  const double against_it = std::log((1.0 - config_.seen_rate) / (1.0 - config_.stray_rate));
  std::vector<std::int32_t> gone;
  for (const Miss& miss : misses) {
    landmarks.change(miss.index, [&](LandmarkRecord& r) {
      r.presence += static_cast<float>(miss.weight * against_it);
    });
    if (landmarks[miss.index].presence < config_.log_odds_gone) gone.push_back(miss.index);
  }
  std::sort(gone.begin(), gone.end());
  return gone;
}

}  // namespace orchard::mapping
