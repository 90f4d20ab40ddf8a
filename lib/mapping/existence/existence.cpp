// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/existence/existence.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"

namespace orchard::mapping {
namespace {

/// Probability that beams pass through where a standing thing is: thin things and wrong poses.
constexpr double kPassRate = 0.1;

/// The same where a thing is gone: something else may stand in front.
constexpr double kPassRateGone = 0.7;

/// Beams across a thing from which on their evidence counts in full.
constexpr int kFullBeams = 6;

/// Most log odds that observations of beams give a thing, so that it can be given up again.
constexpr double kBeamLogOddsMax = 8.0;

/// Log odds of existence below which a landmark is dropped (12 %).
constexpr double kLogOddsGone = -2.0;

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

/// Base, its axes, and the laser of one scan in map.
struct ScanFrame {
  ScanFrame(const pose::PoseEstimate& T_map_base, const Vector2d& p_base_laser)
      : base_map(T_map_base.x_m, T_map_base.y_m),
        R_map_base(T_map_base.yaw_rad),
        laser_map(base_map + R_map_base * p_base_laser) {}

  Vector2d to_base(const Vector2d& p_map) const {
    return R_map_base.inverse() * (p_map - base_map);
  }
  /// From the laser, axes of base.
  Vector2d to_laser(const Vector2d& p_map) const {
    return R_map_base.inverse() * (p_map - laser_map);
  }

  Vector2d base_map;
  Eigen::Rotation2Dd R_map_base;
  Vector2d laser_map;
};

int weight_as_witness(const LandmarkRecord& r) { return std::min(r.num_all, kWitnessMost); }

}  // namespace

/// What one look says of each landmark in view.
struct PresenceWatch::Verdicts {
  struct Verdict {
    std::int32_t index = 0;
    double log_odds = 0.0;  ///< that it stands there still
  };
  std::vector<Verdict> verdicts;
  double log_odds_max = 0.0;           ///< however often it was found, it can go away
  int for_pose = 0, against_pose = 0;  ///< weights of what is found and of what is missed
};

void PresenceWatch::acknowledge(const std::vector<std::int32_t>& observed,
                                const Vector2d& laser_map, LandmarkTable& landmarks) const {
  const double for_it = std::log(config_.seen_rate / config_.stray_rate);
  for (const std::int32_t i : observed) {
    landmarks.change(i, [&](LandmarkRecord& r) {
      r.presence = static_cast<float>(std::min(config_.log_odds_max, r.presence + for_it));
      r.sides_seen |= bit(side_of(laser_map - r.anchor()));
    });
  }
}

PresenceWatch::Verdicts PresenceWatch::of_beams(const std::vector<std::int32_t>& observed,
                                                const pose::PoseEstimate& T_map_base,
                                                const BeamLook& look,
                                                const LandmarkTable& landmarks) const {
  const double past_it = std::log(kPassRate / kPassRateGone);
  const double from_it = std::log((1.0 - kPassRate) / (1.0 - kPassRateGone));
  const ScanFrame frame(T_map_base, p_base_laser_);
  const std::int32_t scan = observed.empty() ? -1 : landmarks[observed.front()].last_scan;
  Verdicts all;
  all.log_odds_max = kBeamLogOddsMax;
  for (const std::int32_t i : observed) all.verdicts.push_back({i, from_it});
  landmarks.near(frame.laser_map, kBeamReach_m, [&](std::int32_t i, const auto& r) {
    if (r.last_scan == scan) {
      all.for_pose += weight_as_witness(r);
      return;
    }
    const double sd_m = std::hypot(sd_at(T_map_base, r.anchor()), std::sqrt(r.scatter_m2));
    const BeamAnswer answer = look.at(frame.to_base(r.anchor()), r.width_m, sd_m);
    const double share = std::min(1.0, static_cast<double>(answer.num_across) / kFullBeams);
    switch (answer.verdict) {
      case BeamVerdict::kUnknown:
        break;
      case BeamVerdict::kReturns:
        all.for_pose += weight_as_witness(r);
        all.verdicts.push_back({i, from_it});
        break;
      case BeamVerdict::kSeesPast:
        all.against_pose += weight_as_witness(r);
        all.verdicts.push_back({i, share * share * past_it});
        break;
    }
  });
  return all;
}

PresenceWatch::Verdicts PresenceWatch::of_detections(const std::vector<Candidate>& candidates,
                                                     const std::vector<std::int32_t>& observed,
                                                     const pose::PoseEstimate& T_map_base,
                                                     const LandmarkTable& landmarks) {
  const ScanFrame frame(T_map_base, p_base_laser_);
  std::vector<pose::Sighting> sightings;
  for (const Candidate& c : candidates) {
    pose::Sighting s;
    s.p_base = frame.to_laser(c.p_aligned);
    s.width_m = c.detection->width_m;
    sightings.push_back(s);
  }
  sight_.learn(sightings);
  Verdicts all;
  all.log_odds_max = config_.log_odds_max;
  if (observed.empty()) return all;
  const pose::Shadows shadows(sightings);
  const auto is_something_at = [&](const Vector2d& p_map) {
    return std::any_of(candidates.begin(), candidates.end(), [&](const Candidate& c) {
      const double beside_m = kBeside_m + 0.5 * c.detection->width_m;
      return (c.p_aligned - p_map).squaredNorm() < beside_m * beside_m;
    });
  };
  for (const std::int32_t i : observed) {
    if (!sight_.covers(frame.to_laser(landmarks[i].anchor()))) continue;
    all.for_pose += weight_as_witness(landmarks[i]);
  }
  const double against_it = std::log((1.0 - config_.seen_rate) / (1.0 - config_.stray_rate));
  const std::int32_t scan = landmarks[observed.front()].last_scan;
  landmarks.near(frame.laser_map, sight_.range_m(), [&](std::int32_t i, const LandmarkRecord& r) {
    if (r.last_scan == scan) return;
    const Vector2d p = frame.to_laser(r.anchor());
    if (!sight_.covers(p) || shadows.hide(p) || is_something_at(r.anchor())) return;
    const int side = side_of(frame.laser_map - r.anchor());
    const bool is_known_side = (r.sides_seen & (bit(side - 1) | bit(side) | bit(side + 1))) != 0;
    all.verdicts.push_back({i, (is_known_side ? 1.0 : kUnseenSide) * against_it});
    all.against_pose += weight_as_witness(r);
  });
  return all;
}

std::vector<std::int32_t> PresenceWatch::review(const std::vector<Candidate>& candidates,
                                                const std::vector<std::int32_t>& observed,
                                                const pose::PoseEstimate& T_map_base,
                                                const BeamLook* look, LandmarkTable& landmarks) {
  if (!config_.enabled) return {};
  const auto period_us = static_cast<std::int64_t>(1e6 * config_.period_s);
  const std::int64_t since_us = last_utime_ ? T_map_base.utime - *last_utime_ : period_us;
  const bool counts = since_us < 0 || since_us >= period_us;
  if (counts) by_beams_ = look != nullptr;
  if (!by_beams_) {
    acknowledge(observed, ScanFrame(T_map_base, p_base_laser_).laser_map, landmarks);
  }
  if (!counts) return {};
  last_utime_ = T_map_base.utime;

  const Verdicts all = look != nullptr ? of_beams(observed, T_map_base, *look, landmarks)
                                       : of_detections(candidates, observed, T_map_base, landmarks);
  if (all.against_pose > all.for_pose) return {};
  std::vector<std::int32_t> gone;
  for (const auto& verdict : all.verdicts) {
    landmarks.change(verdict.index, [&](LandmarkRecord& r) {
      r.presence = static_cast<float>(std::min(all.log_odds_max, r.presence + verdict.log_odds));
    });
    if (landmarks[verdict.index].presence < kLogOddsGone) gone.push_back(verdict.index);
  }
  std::sort(gone.begin(), gone.end());
  return gone;
}

}  // namespace orchard::mapping
