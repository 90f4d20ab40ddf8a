// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/existence/flicker.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/pose2.hpp"
#include "mapping/candidate.hpp"
#include "mapping/existence/existence_odds.hpp"

namespace orchard::mapping {
namespace {

/// A longer gap between observations means that the robot left and came back [us].
constexpr std::int64_t kOutOfSight_us = 20'000'000;
/// A stalk is thinner than the beam spacing and is hit by two beams at most.
constexpr int kStalkBeamsMax = 2;

double distance_from_m(const pose::PoseEstimate& pose, const Eigen::Vector2d& p_map) {
  return (Eigen::Vector2d(pose.x_m, pose.y_m) - p_map).norm();
}

}  // namespace

std::vector<std::int32_t> stalk_observations(const MapState& map, const LandmarkRecord& r) {
  if (label_of(r, map.config) == detection::Label::kTree) return {};
  std::vector<std::int32_t> newest =
      map.observations.newest_of(r.last_observation, kStalkObservationsMax);
  if (newest.size() == kStalkObservationsMax) return {};
  const bool is_thin = std::all_of(newest.begin(), newest.end(), [&](std::int32_t k) {
    const int num_beams = map.observations[k].num_beams;
    return num_beams > 0 && num_beams <= kStalkBeamsMax;
  });
  if (!is_thin) newest.clear();
  return newest;
}

bool is_flickering(const MapState& map, const LandmarkRecord& r) {
  const std::vector<std::int32_t> newest = stalk_observations(map, r);
  if (newest.empty()) return false;
  const Eigen::Vector2d p_map = r.association_position();
  double farthest_m = 0.0;
  for (const std::int32_t k : newest) {
    const Observation& o = map.observations[k];
    farthest_m = std::max(farthest_m, distance_from_m(map.observations.pose(o.scan), p_map));
  }
  double log_odds = static_cast<double>(newest.size()) * log_odds_of_return();
  for (std::size_t k = 1; k < newest.size(); ++k) {
    const std::int32_t later = map.observations[newest[k - 1]].scan;
    const std::int32_t earlier = map.observations[newest[k]].scan;
    const std::int64_t later_us = map.observations.pose(later).utime;
    if (later_us - map.observations.pose(earlier).utime > kOutOfSight_us) continue;
    bool has_view = true;  // of the last scan with stored beams
    for (std::int32_t scan = earlier + 1; scan < later; ++scan) {
      const pose::PoseEstimate& pose = map.observations.pose(scan);
      if (distance_from_m(pose, p_map) > farthest_m) continue;
      if (const auto beams = map.observations.free_space(scan)) {
        const Eigen::Vector2d p_base =
            geometry::inverse_transform(geometry::Pose2{pose.x_m, pose.y_m, pose.yaw_rad}, p_map);
        const double sd_m =
            std::hypot(pose_induced_sd_m(pose, p_map), std::sqrt(std::max(0.0f, r.scatter_m2)));
        has_view = beams->at(p_base, r.width_m, sd_m).evidence != FreeSpaceEvidence::kUnknown;
      }
      if (has_view) {
        log_odds += log_odds_of({FreeSpaceEvidence::kPassesThrough, 0}, BeamWeight::kFull);
      }
    }
  }
  return log_odds < kLogOddsGone;
}

}  // namespace orchard::mapping
