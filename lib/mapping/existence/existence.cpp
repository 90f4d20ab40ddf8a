// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/existence/existence.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "geometry/pose2.hpp"
#include "mapping/candidate.hpp"
#include "mapping/extent/extent.hpp"
#include "mapping/landmark_record.hpp"
#include "mapping/tuning.hpp"

namespace orchard::mapping {
namespace {

/// derived: Upper limit of pose_weight().
constexpr int kPoseWeightMax = 100;

}  // namespace

double log_odds_of_return() {
  return std::log((1.0 - tuning::kPassRate) / (1.0 - tuning::kPassRateGone));
}

double log_odds_of(const FreeSpaceAnswer& answer, BeamWeight weight) {
  const double fraction =
      weight == BeamWeight::kFull
          ? 1.0
          : std::min(1.0, static_cast<double>(answer.num_across) / tuning::kFullBeams);
  switch (answer.evidence) {
    case FreeSpaceEvidence::kUnknown:
      break;
    case FreeSpaceEvidence::kReturns:
      return log_odds_of_return();
    case FreeSpaceEvidence::kPassesThrough:
      return fraction * fraction * std::log(tuning::kPassRate / tuning::kPassRateGone);
  }
  return 0.0;
}

int pose_weight(int num_observations) { return std::min(num_observations, kPoseWeightMax); }

namespace {

/// derived: Number of scans stored for was_free_before(): one minute at most.
constexpr std::size_t kObservationsMax = 240;

using Eigen::Vector2d;

}  // namespace

bool ExistenceFilter::was_free_before(const Vector2d& p_map, double width_m, double sd_m) const {
  double log_odds = log_odds_of_return();  // the observation itself
  for (const Observation& observation : observations_) {
    const Vector2d base_map(observation.T_map_base.x_m, observation.T_map_base.y_m);
    if ((base_map - p_map).norm() > kBeamReach_m) continue;
    const Vector2d p_base =
        Eigen::Rotation2Dd(observation.T_map_base.yaw_rad).inverse() * (p_map - base_map);
    log_odds += log_odds_of(observation.free_space->at(
        p_base, width_m, std::hypot(sd_m, pose_induced_sd_m(observation.T_map_base, p_map))));
  }
  return log_odds < tuning::kLogOddsGone;
}

/// Evidence of one scan's beams for and against each landmark in view.
struct ExistenceFilter::Evidence {
  struct OfLandmark {
    std::int32_t index = 0;
    double log_odds = 0.0;  ///< change of the log odds of existence
  };
  std::vector<OfLandmark> of_landmarks;
  int for_pose = 0, against_pose = 0;  ///< sums of pose_weight() of landmarks found and missed
};

ExistenceFilter::Evidence ExistenceFilter::evidence_of(const std::vector<std::int32_t>& changed_ids,
                                                       const pose::PoseEstimate& T_map_base,
                                                       const FreeSpace& free_space,
                                                       const LandmarkTable& landmarks) const {
  const Vector2d base_map(T_map_base.x_m, T_map_base.y_m);
  const Eigen::Rotation2Dd R_map_base(T_map_base.yaw_rad);
  const Vector2d laser_map = base_map + R_map_base * p_base_laser_;
  const std::int32_t scan = changed_ids.empty() ? -1 : landmarks[changed_ids.front() - 1].last_scan;
  Evidence all;
  for (const std::int32_t id : changed_ids)
    all.of_landmarks.push_back({id - 1, log_odds_of_return()});
  landmarks.near(laser_map, kBeamReach_m, [&](std::int32_t i, const LandmarkRecord& r) {
    if (r.last_scan == scan) {
      all.for_pose += pose_weight(r.num_all);
      return;
    }
    const Vector2d p_map = r.association_position();
    const double sd_m = std::hypot(pose_induced_sd_m(T_map_base, p_map), std::sqrt(r.scatter_m2));
    const Vector2d p_base = R_map_base.inverse() * (p_map - base_map);
    const FreeSpaceAnswer answer = free_space.at(p_base, r.width_m, sd_m);
    if (answer.evidence == FreeSpaceEvidence::kUnknown) return;
    const bool passes = answer.evidence == FreeSpaceEvidence::kPassesThrough;
    (passes ? all.against_pose : all.for_pose) += pose_weight(r.num_all);
    all.of_landmarks.push_back({i, log_odds_of(answer)});
  });
  return all;
}

void ExistenceFilter::update(const std::shared_ptr<const FreeSpace>& free_space,
                             const pose::PoseEstimate& T_map_base, LandmarkTable& landmarks,
                             MapUpdate& update) {
  const auto period_us = static_cast<std::int64_t>(1e6 * config_.period_s);
  if (last_utime_ && T_map_base.utime - *last_utime_ < period_us) return;
  last_utime_ = T_map_base.utime;

  const Evidence all = evidence_of(update.changed_ids, T_map_base, *free_space, landmarks);
  if (all.against_pose > all.for_pose) return;
  observations_.push_back({T_map_base, free_space});
  if (observations_.size() > kObservationsMax) observations_.pop_front();
  std::vector<std::int32_t> gone;
  for (const Evidence::OfLandmark& evidence : all.of_landmarks) {
    landmarks.change(evidence.index, [&](LandmarkRecord& r) {
      r.existence_log_odds = static_cast<float>(
          std::min(tuning::kBeamLogOddsMax, r.existence_log_odds + evidence.log_odds));
    });
    if (landmarks[evidence.index].existence_log_odds < tuning::kLogOddsGone) {
      gone.push_back(evidence.index);
    }
  }
  std::sort(gone.begin(), gone.end());
  for (const std::int32_t index : gone) {
    landmarks.remove(index);
    update.removed_ids.push_back(index + 1);
  }
}

namespace {

/// 1-sigma distance of a landmark from its expected position in a scan of this pose [m].
double view_sd_m(const pose::PoseEstimate& pose, const LandmarkRecord& r) {
  return std::hypot(pose_induced_sd_m(pose, r.association_position()),
                    std::sqrt(std::max(0.0f, r.scatter_m2)));
}

/// Validates the pose of each scan: it must find more of the mapped landmarks around it than it
/// misses.
class TrustedScans {
 public:
  explicit TrustedScans(const MapState& map) : map_(map) {}

  bool holds(std::int32_t scan, const FreeSpace& beams) {
    const auto [at, is_new] = is_trusted_.try_emplace(scan, false);
    if (is_new) at->second = finds_more_than_it_misses(map_.observations.pose(scan), beams);
    return at->second;
  }

 private:
  bool finds_more_than_it_misses(const pose::PoseEstimate& pose, const FreeSpace& beams) const {
    const geometry::Pose2 T_map_base{pose.x_m, pose.y_m, pose.yaw_rad};
    int balance = 0;
    const auto weigh = [&](std::int32_t, const LandmarkRecord& r) {
      const Eigen::Vector2d p_base =
          geometry::inverse_transform(T_map_base, r.association_position());
      const FreeSpaceAnswer answer = beams.at(p_base, r.width_m, view_sd_m(pose, r));
      if (answer.evidence == FreeSpaceEvidence::kReturns) balance += pose_weight(r.num_all);
      if (answer.evidence == FreeSpaceEvidence::kPassesThrough) balance -= pose_weight(r.num_all);
    };
    map_.landmarks.near({pose.x_m, pose.y_m}, kBeamReach_m, weigh);
    return balance >= 0;
  }

  const MapState& map_;
  std::map<std::int32_t, bool> is_trusted_;
};

/// Log odds of a position from the scans before an object came (in order of time) or after it left
/// (in reverse order). The time of the change is unknown: takes the minimum over all prefixes and
/// adds log(1 + number of scans) for testing that many times.
double of_absence(const std::vector<double>& log_odds) {
  double sum = 0.0, least = 0.0;
  for (const double odds : log_odds) least = std::min(least, sum += odds);
  return std::min(0.0, least + std::log(1.0 + static_cast<double>(log_odds.size())));
}

Eigen::Vector2d base_position(const MapState& map, std::int32_t scan,
                              const Eigen::Vector2d& p_map) {
  const pose::PoseEstimate& pose = map.observations.pose(scan);
  return geometry::inverse_transform(geometry::Pose2{pose.x_m, pose.y_m, pose.yaw_rad}, p_map);
}

/// Log odds that a landmark exists, from all scans with a view of its position: the lower of those
/// against stray observations of nothing and those against an object that came and went. Scans
/// between its first and last observation are no evidence against the latter, nor are scans from
/// farther away than it was ever observed: how far a dark or thin object is detected is known only
/// from its own observations.
double log_odds_of_drive(const MapState& map, const LandmarkRecord& r, TrustedScans& trusted,
                         GroundOccupancy& ground) {
  const Eigen::Vector2d p_map = r.association_position();
  std::vector<std::int32_t> seen_in;
  double seen_range_max_m = 0.0;
  for (const std::int32_t k :
       map.observations.newest_of(r.last_observation, tuning::kStrayObservationsMax)) {
    const std::int32_t scan = map.observations[k].scan;
    seen_in.push_back(scan);
    seen_range_max_m = std::max(seen_range_max_m, base_position(map, scan, p_map).norm());
  }
  std::sort(seen_in.begin(), seen_in.end());
  int num_seen = 0;
  double sum = 0.0;
  std::map<std::int32_t, double> in_range;
  ground.visit_views(p_map, [&](std::int32_t scan, const FreeSpace& beams) {
    if (std::binary_search(seen_in.begin(), seen_in.end(), scan)) {
      ++num_seen;
      return true;
    }
    const Eigen::Vector2d p_base = base_position(map, scan, p_map);
    if (p_base.norm() > seen_range_max_m || !trusted.holds(scan, beams)) return true;
    in_range[scan] = log_odds_of(
        beams.at(p_base, r.width_m, view_sd_m(map.observations.pose(scan), r)), BeamWeight::kFull);
    sum += in_range[scan];
    return true;
  });
  std::vector<double> before, after;
  for (const auto& [scan, odds] : in_range) {
    if (odds == 0.0) continue;
    if (scan < seen_in.front()) before.push_back(odds);
    if (scan > seen_in.back()) after.push_back(odds);
  }
  std::reverse(after.begin(), after.end());
  // GroundOccupancy skips scans from the same place, so the first observation may be missing: count
  // one at least.
  return std::min(sum + std::max(1, num_seen) * log_odds_of_return(),
                  of_absence(before) + of_absence(after) + log_odds_of_return());
}

/// Whether a landmark is foliage of a bush that looked like a trunk: a real stem in a bush or at
/// its border is observed in a good part of the scans that observe the bush.
bool is_of_a_bush(const MapState& map, std::int32_t index) {
  const LandmarkRecord& r = map.landmarks[index];
  if (r.is_clump) return false;
  bool is_part = false;
  map.landmarks.near(
      r.association_position(),
      0.5 * (r.width_m + map.config.object_width_max_m) + tuning::kTouch_m,
      [&](std::int32_t i, const LandmarkRecord& bush) {
        if (i == index || !bush.is_clump) return;
        if (r.num_all >= tuning::kStemFraction * bush.num_all) return;
        const double apart_m = (bush.association_position() - r.association_position()).norm();
        is_part |= apart_m < extent_radius_m(bush) + 0.5 * r.width_m + tuning::kTouch_m;
      });
  return is_part;
}

/// Whether scans saw most of the ground of a wide landmark free, its position among it: a single
/// view of an object half occluded or passing by has any width. Beams end at what stands there.
bool stands_on_free_ground(const LandmarkRecord& r, double object_width_max_m,
                           GroundOccupancy& ground) {
  const double radius_m = std::min(extent_radius_m(r), object_width_max_m);
  if (2.0 * radius_m <= kSeenPlace_m || !ground.is_free(r.association_position())) return false;
  int num = 1, num_free = 1;  // its position
  for (double x_m = -radius_m; x_m <= radius_m; x_m += kSeenPlace_m) {
    for (double y_m = -radius_m; y_m <= radius_m; y_m += kSeenPlace_m) {
      const Eigen::Vector2d arm(x_m, y_m);
      if (arm.norm() > radius_m) continue;
      ++num;
      num_free += ground.is_free(r.association_position() + arm);
    }
  }
  return num_free >= tuning::kPassFraction * num;
}

}  // namespace

std::vector<std::int32_t> spurious_landmarks(const MapState& map, GroundOccupancy& ground) {
  std::vector<std::int32_t> strays;
  TrustedScans trusted(map);
  for (std::int32_t i = 0; i < map.landmarks.num_indices(); ++i) {
    const LandmarkRecord& r = map.landmarks[i];
    if (r.is_removed || r.num_all >= tuning::kStrayObservationsMax) continue;
    if (is_of_a_bush(map, i) || stands_on_free_ground(r, map.config.object_width_max_m, ground) ||
        log_odds_of_drive(map, r, trusted, ground) < tuning::kLogOddsGone) {
      strays.push_back(i);
    }
  }
  return strays;
}

}  // namespace orchard::mapping
