// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/existence/existence.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "mapping/candidate.hpp"
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
  if (!config_.enabled) return;
  const auto period_us = static_cast<std::int64_t>(1e6 * config_.period_s);
  const std::int64_t since_us = last_utime_ ? T_map_base.utime - *last_utime_ : period_us;
  if (since_us >= 0 && since_us < period_us) return;
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

}  // namespace orchard::mapping
