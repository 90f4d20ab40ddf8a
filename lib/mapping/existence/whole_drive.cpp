// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/existence/whole_drive.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "geometry/pose2.hpp"
#include "mapping/candidate.hpp"
#include "mapping/existence/existence_odds.hpp"

namespace orchard::mapping {
namespace {

/// What was seen so often was no stray observation.
constexpr int kStrayObservationsMost = 30;

/// Log odds that a landmark stands there, by every scan with a view of its place.
double log_odds_of_drive(const MapState& map, const LandmarkRecord& r, SeenGround& ground) {
  std::vector<std::int32_t> seen_in;
  for (const std::int32_t k :
       map.observations.newest_of(r.last_observation, kStrayObservationsMost)) {
    seen_in.push_back(map.observations[k].scan);
  }
  std::sort(seen_in.begin(), seen_in.end());
  const Eigen::Vector2d p_map = r.association_position();
  int num_seen = 0;
  double log_odds = 0.0;
  ground.visit_views(p_map, [&](std::int32_t scan, const FreeSpace& beams) {
    if (std::binary_search(seen_in.begin(), seen_in.end(), scan)) {
      ++num_seen;
      return true;
    }
    const pose::PoseEstimate& pose = map.observations.pose(scan);
    const Eigen::Vector2d p_base =
        geometry::transform_back(geometry::Pose2{pose.x_m, pose.y_m, pose.yaw_rad}, p_map);
    const double sd_m = std::hypot(sd_at(pose, p_map), std::sqrt(std::max(0.0f, r.scatter_m2)));
    log_odds += log_odds_of(beams.at(p_base, r.width_m, sd_m), BeamWeight::kFull);
    return true;
  });
  // its first observation may be of a scan from where the one before was
  return log_odds + std::max(1, num_seen) * log_odds_of_return();
}

}  // namespace

std::vector<std::int32_t> stray_landmarks(const MapState& map, SeenGround& ground) {
  std::vector<std::int32_t> strays;
  for (std::int32_t i = 0; i < map.landmarks.num_indices(); ++i) {
    const LandmarkRecord& r = map.landmarks[i];
    if (r.is_removed || r.num_all >= kStrayObservationsMost) continue;
    if (log_odds_of_drive(map, r, ground) < kLogOddsGone) strays.push_back(i);
  }
  return strays;
}

}  // namespace orchard::mapping
