// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/trajectory/trajectory_evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "evaluation/trajectory/track_association.hpp"
#include "geometry/angles.hpp"
#include "geometry/rigid_fit2.hpp"
#include "geometry/statistics.hpp"

namespace orchard::evaluation {
namespace {

using geometry::wrap_angle_rad;

void require_order(const Track& track, const char* which) {
  for (std::size_t i = 1; i < track.poses.size(); ++i) {
    if (track.poses[i].utime <= track.poses[i - 1].utime) {
      throw std::invalid_argument(std::string("evaluate_trajectory: the time of the ") + which +
                                  " is not ascending");
    }
  }
}

void require_positive(double value, const char* what) {
  if (!(value > 0.0) || !std::isfinite(value)) {
    throw std::invalid_argument(std::string("evaluate_trajectory: ") + what + " must be positive");
  }
}

geometry::Pose2 pose_of(const TrackPose& pose) { return {pose.x_m, pose.y_m, pose.yaw_rad}; }

TrackPose moved(const geometry::Pose2& motion, const TrackPose& pose) {
  const geometry::Pose2 is = compose(motion, pose_of(pose));
  return {pose.utime, is.x_m, is.y_m, is.yaw_rad};
}

/// Pose `to` relative to `from`.
TrackPose relative(const TrackPose& from, const TrackPose& to) {
  const geometry::Pose2 seen = between(pose_of(from), pose_of(to));
  return {to.utime, seen.x_m, seen.y_m, seen.yaw_rad};
}

double distance_m(const TrackPose& a, const TrackPose& b) {
  return std::hypot(b.x_m - a.x_m, b.y_m - a.y_m);
}

geometry::Pose2 align(const std::vector<ComparedPose>& compared, Alignment alignment,
                      bool has_yaw) {
  if (alignment == Alignment::kNone || compared.empty()) return {};
  if (alignment == Alignment::kOrigin) {
    const TrackPose& truth = compared.front().truth;
    const TrackPose& estimate = compared.front().estimate;
    const double yaw_rad = has_yaw ? wrap_angle_rad(truth.yaw_rad - estimate.yaw_rad) : 0.0;
    const TrackPose turned = moved({0.0, 0.0, yaw_rad}, estimate);
    return {truth.x_m - turned.x_m, truth.y_m - turned.y_m, yaw_rad};
  }
  std::vector<Eigen::Vector2d> from, to;
  for (const ComparedPose& pair : compared) {
    from.emplace_back(pair.estimate.x_m, pair.estimate.y_m);
    to.emplace_back(pair.truth.x_m, pair.truth.y_m);
  }
  return geometry::fit_rigid(to, from).T_a_b;
}

/// Progress of each compared pose of the estimate: metres driven, seconds, or frames.
std::vector<double> progress(const std::vector<ComparedPose>& compared, DeltaUnit unit) {
  std::vector<double> along(compared.size(), 0.0);
  for (std::size_t i = 1; i < compared.size(); ++i) {
    const double step = unit == DeltaUnit::kMetres
                            ? distance_m(compared[i - 1].estimate, compared[i].estimate)
                        : unit == DeltaUnit::kSeconds
                            ? 1e-6 * static_cast<double>(compared[i].utime - compared[i - 1].utime)
                            : 1.0;
    along[i] = along[i - 1] + step;
  }
  return along;
}

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

/// Consecutive segments, each ending where it first reaches delta. Like in evo, the first pair
/// begins at the end of the first segment, except for frames.
Pairs consecutive_pairs(const std::vector<double>& along, const TrajectoryRules& rules) {
  constexpr double kRounding = 1e-9;
  Pairs pairs;
  if (along.empty()) return pairs;
  std::vector<std::size_t> ends;
  if (rules.unit == DeltaUnit::kFrames) ends.push_back(0);
  double begin = along.front();
  for (std::size_t i = 1; i < along.size(); ++i) {
    if (along[i] - begin < rules.delta * (1.0 - kRounding)) continue;
    ends.push_back(i);
    begin = along[i];
  }
  for (std::size_t i = 1; i < ends.size(); ++i) pairs.emplace_back(ends[i - 1], ends[i]);
  return pairs;
}

/// Pairs from every pose to the one nearest to delta ahead, within the tolerance.
Pairs all_pairs(const std::vector<double>& along, const TrajectoryRules& rules) {
  Pairs pairs;
  for (std::size_t i = 0; i + 1 < along.size(); ++i) {
    const double wanted = along[i] + rules.delta;
    const auto first = along.begin() + static_cast<std::ptrdiff_t>(i) + 1;
    auto it = std::lower_bound(first, along.end(), wanted);
    if (it == along.end() || (it != first && wanted - *(it - 1) <= *it - wanted)) {
      if (it == first) continue;
      --it;
    }
    // Of several poses at one position (a standing robot), the earliest.
    it = std::lower_bound(first, along.end(), *it);
    if (std::abs(*it - wanted) > rules.delta * rules.delta_tolerance) continue;
    pairs.emplace_back(i, static_cast<std::size_t>(it - along.begin()));
  }
  return pairs;
}

void judge_relative(const TrajectoryRules& rules, TrajectoryEvaluation& evaluation) {
  const std::vector<ComparedPose>& compared = evaluation.compared;
  const std::vector<double> along = progress(compared, rules.unit);
  std::vector<double> translations_m, rotations_rad;
  for (const auto& [i, j] :
       rules.all_pairs ? all_pairs(along, rules) : consecutive_pairs(along, rules)) {
    if (!evaluation.has_yaw) {
      translations_m.push_back(std::abs(distance_m(compared[i].truth, compared[j].truth) -
                                        distance_m(compared[i].estimate, compared[j].estimate)));
      continue;
    }
    const TrackPose error = relative(relative(compared[i].truth, compared[j].truth),
                                     relative(compared[i].estimate, compared[j].estimate));
    translations_m.push_back(std::hypot(error.x_m, error.y_m));
    rotations_rad.push_back(std::abs(error.yaw_rad));
  }
  evaluation.relative_position_m = error_statistics(std::move(translations_m));
  evaluation.relative_yaw_rad = error_statistics(std::move(rotations_rad));
}

}  // namespace

ErrorStatistics error_statistics(std::vector<double> errors) {
  ErrorStatistics statistics;
  statistics.num = static_cast<int>(errors.size());
  if (errors.empty()) return statistics;
  const auto n = static_cast<double>(errors.size());
  double sum = 0.0, sum_of_squares = 0.0;
  for (const double error : errors) {
    sum += error;
    sum_of_squares += error * error;
  }
  statistics.mean = sum / n;
  statistics.rmse = std::sqrt(sum_of_squares / n);
  double squares_about_mean = 0.0;
  for (const double error : errors) squares_about_mean += std::pow(error - statistics.mean, 2);
  statistics.sd = std::sqrt(squares_about_mean / n);
  const auto [least, greatest] = std::minmax_element(errors.begin(), errors.end());
  statistics.min = *least;
  statistics.max = *greatest;
  statistics.median = geometry::midpoint_median(std::move(errors));
  return statistics;
}

TrajectoryEvaluation evaluate_trajectory(const Track& estimate, const Track& truth,
                                         const TrajectoryRules& rules) {
  require_order(estimate, "estimate");
  require_order(truth, "truth");
  require_positive(rules.delta, "delta");
  require_positive(rules.max_difference_s, "the largest difference in time");
  if (rules.gap_max_s) require_positive(*rules.gap_max_s, "the longest gap");

  TrajectoryEvaluation evaluation;
  evaluation.num_estimates = static_cast<int>(estimate.poses.size());
  evaluation.num_true = static_cast<int>(truth.poses.size());
  evaluation.has_yaw = truth.has_yaw && estimate.has_yaw;
  associate(estimate, truth, rules, evaluation);
  evaluation.T_truth_estimate = align(evaluation.compared, rules.alignment, evaluation.has_yaw);

  std::vector<double> distances_m, turns_rad;
  const TrackPose* before = nullptr;
  double way_m = 0.0;
  for (ComparedPose& pair : evaluation.compared) {
    pair.estimate = moved(evaluation.T_truth_estimate, pair.estimate);
    if (before != nullptr) way_m += distance_m(*before, pair.truth);
    before = &pair.truth;
    pair.way_m = way_m;
    pair.position_error_m = distance_m(pair.truth, pair.estimate);
    distances_m.push_back(pair.position_error_m);
    if (!evaluation.has_yaw) continue;
    pair.yaw_error_rad = wrap_angle_rad(pair.estimate.yaw_rad - pair.truth.yaw_rad);
    turns_rad.push_back(std::abs(pair.yaw_error_rad));
  }
  evaluation.position_m = error_statistics(std::move(distances_m));
  evaluation.yaw_rad = error_statistics(std::move(turns_rad));
  judge_relative(rules, evaluation);
  return evaluation;
}

}  // namespace orchard::evaluation
