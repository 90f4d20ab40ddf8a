// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/trajectory/track_association.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"

namespace orchard::evaluation {
namespace {

using Iterator = std::vector<TrackPose>::const_iterator;

Iterator not_before(const std::vector<TrackPose>& poses, std::int64_t utime) {
  return std::lower_bound(poses.begin(), poses.end(), utime,
                          [](const TrackPose& pose, std::int64_t t) { return pose.utime < t; });
}

TrackPose interpolate(const TrackPose& before, const TrackPose& after, std::int64_t utime) {
  const double fraction =
      static_cast<double>(utime - before.utime) / static_cast<double>(after.utime - before.utime);
  const double turn_rad = geometry::wrap_angle_rad(after.yaw_rad - before.yaw_rad);
  return {utime, before.x_m + fraction * (after.x_m - before.x_m),
          before.y_m + fraction * (after.y_m - before.y_m),
          geometry::wrap_angle_rad(before.yaw_rad + fraction * turn_rad)};
}

void associate_between(const Track& estimate, const Track& truth,
                       TrajectoryEvaluation& evaluation) {
  for (const TrackPose& pose : estimate.poses) {
    const auto after = not_before(truth.poses, pose.utime);
    if (after != truth.poses.end() && after->utime == pose.utime) {
      evaluation.compared.push_back({pose.utime, pose, *after});
    } else if (after == truth.poses.begin() || after == truth.poses.end()) {
      ++evaluation.num_outside;
    } else if (static_cast<double>(after->utime - std::prev(after)->utime) >
               1e6 * evaluation.gap_max_s) {
      ++evaluation.num_in_gaps;
    } else {
      evaluation.compared.push_back(
          {pose.utime, pose, interpolate(*std::prev(after), *after, pose.utime)});
    }
  }
}

/// The nearer of the two poses around a time; the earlier at equal distance.
const TrackPose& nearest(const std::vector<TrackPose>& poses, std::int64_t utime) {
  const auto after = not_before(poses, utime);
  if (after == poses.end()) return poses.back();
  if (after == poses.begin()) return *after;
  return after->utime - utime < utime - std::prev(after)->utime ? *after : *std::prev(after);
}

void associate_nearest(const Track& estimate, const Track& truth, double max_difference_s,
                       TrajectoryEvaluation& evaluation) {
  const bool estimate_is_longer = estimate.poses.size() > truth.poses.size();
  const Track& shorter = estimate_is_longer ? truth : estimate;
  const Track& longer = estimate_is_longer ? estimate : truth;
  for (const TrackPose& pose : shorter.poses) {
    const TrackPose* partner = longer.poses.empty() ? nullptr : &nearest(longer.poses, pose.utime);
    if (partner == nullptr ||
        static_cast<double>(std::abs(partner->utime - pose.utime)) > 1e6 * max_difference_s) {
      ++evaluation.num_unmatched;
      continue;
    }
    const TrackPose& estimated = estimate_is_longer ? *partner : pose;
    evaluation.compared.push_back(
        {estimated.utime, estimated, estimate_is_longer ? pose : *partner});
  }
}

}  // namespace

double median_gap_s(const Track& truth) {
  std::vector<double> intervals_s;
  for (std::size_t i = 1; i < truth.poses.size(); ++i) {
    intervals_s.push_back(1e-6 *
                          static_cast<double>(truth.poses[i].utime - truth.poses[i - 1].utime));
  }
  return 3.0 * error_statistics(std::move(intervals_s)).median;
}

void associate(const Track& estimate, const Track& truth, const TrajectoryRules& rules,
               TrajectoryEvaluation& evaluation) {
  if (rules.association == Association::kNearest) {
    associate_nearest(estimate, truth, rules.max_difference_s, evaluation);
    return;
  }
  evaluation.gap_max_s = rules.gap_max_s ? *rules.gap_max_s : median_gap_s(truth);
  associate_between(estimate, truth, evaluation);
}

}  // namespace orchard::evaluation
