// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/trajectory_evaluation.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/angles.hpp"
#include "geometry/rigid_fit2.hpp"
#include "geometry/statistics.hpp"

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

/// Pairs estimates with the truth at their times, interpolated: fills `compared` (estimate and
/// truth, not the errors) and the numbers of unpaired poses.
void associate(const Track& estimate, const Track& truth, TrajectoryEvaluation& evaluation) {
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

/// Default of the max interval between true poses for interpolation: three times the median
/// interval [s]; 0 for fewer than two poses.
double median_gap_s(const Track& truth) {
  std::vector<double> intervals_s;
  for (std::size_t i = 1; i < truth.poses.size(); ++i) {
    intervals_s.push_back(1e-6 *
                          static_cast<double>(truth.poses[i].utime - truth.poses[i - 1].utime));
  }
  return 3.0 * error_statistics(std::move(intervals_s)).median;
}

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

/// Metres driven by the estimate up to each compared pose.
std::vector<double> progress_m(const std::vector<ComparedPose>& compared) {
  std::vector<double> along_m(compared.size(), 0.0);
  for (std::size_t i = 1; i < compared.size(); ++i) {
    along_m[i] = along_m[i - 1] + distance_m(compared[i - 1].estimate, compared[i].estimate);
  }
  return along_m;
}

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

/// Consecutive segments, each ending where it first reaches delta. Like in evo, the first one
/// begins at the end of the first delta.
Pairs segments(const std::vector<double>& along_m, double delta_m) {
  constexpr double kRounding = 1e-9;
  Pairs pairs;
  std::optional<std::size_t> last_end;
  double begin_m = 0.0;
  for (std::size_t i = 1; i < along_m.size(); ++i) {
    if (along_m[i] - begin_m < delta_m * (1.0 - kRounding)) continue;
    if (last_end) pairs.emplace_back(*last_end, i);
    last_end = i;
    begin_m = along_m[i];
  }
  return pairs;
}

void judge_relative(double delta_m, TrajectoryEvaluation& evaluation) {
  const std::vector<ComparedPose>& compared = evaluation.compared;
  std::vector<double> translations_m, rotations_rad;
  for (const auto& [i, j] : segments(progress_m(compared), delta_m)) {
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
  require_positive(rules.delta_m, "delta");
  if (rules.gap_max_s) require_positive(*rules.gap_max_s, "the longest gap");

  TrajectoryEvaluation evaluation;
  evaluation.num_estimates = static_cast<int>(estimate.poses.size());
  evaluation.num_true = static_cast<int>(truth.poses.size());
  evaluation.has_yaw = truth.has_yaw && estimate.has_yaw;
  evaluation.gap_max_s = rules.gap_max_s ? *rules.gap_max_s : median_gap_s(truth);
  associate(estimate, truth, evaluation);
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
  judge_relative(rules.delta_m, evaluation);
  return evaluation;
}

namespace {

using nlohmann::ordered_json;

constexpr double kDegPerRad = 180.0 / geometry::kPi;

std::string row(const std::string& name, const ErrorStatistics& e, double scale, const char* unit) {
  if (e.num == 0) return fmt::format("{:<26}      -\n", name);
  return fmt::format("{:<26} {:6}  {:9.4f} {:9.4f} {:9.4f} {:9.4f} {:9.4f} {:9.4f}  {}\n", name,
                     e.num, scale * e.rmse, scale * e.mean, scale * e.median, scale * e.sd,
                     scale * e.min, scale * e.max, unit);
}

ordered_json statistics_json(const ErrorStatistics& e) {
  if (e.num == 0) return {{"n", 0}};
  return {{"n", e.num},  {"rmse", e.rmse}, {"mean", e.mean}, {"median", e.median},
          {"std", e.sd}, {"min", e.min},   {"max", e.max}};
}

}  // namespace

std::string trajectory_summary(const TrajectoryEvaluation& evaluation,
                               const TrajectoryRules& rules) {
  std::string text = fmt::format(
      "{} of {} poses compared with {} true poses: {} outside their time, {} in gaps of more than "
      "{:g} s\n",
      evaluation.compared.size(), evaluation.num_estimates, evaluation.num_true,
      evaluation.num_outside, evaluation.num_in_gaps, evaluation.gap_max_s);
  if (rules.alignment != Alignment::kNone) {
    const geometry::Pose2& t = evaluation.T_truth_estimate;
    text +=
        fmt::format("aligned {}: moved by ({:.3f}, {:.3f}) m, rotated by {:.3f} degrees\n",
                    rules.alignment == Alignment::kRigid ? "by least squares" : "at the first pose",
                    t.x_m, t.y_m, kDegPerRad * t.yaw_rad);
  }
  text += fmt::format("{:<26} {:>6}  {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}\n", "", "n", "RMSE",
                      "mean", "median", "sd", "min", "max");
  text += row("APE position (ATE)", evaluation.position_m, 1.0, "m");
  text += row("APE yaw", evaluation.yaw_rad, kDegPerRad, "deg");
  const std::string position_name =
      fmt::format("RPE {}, {:g} m", evaluation.has_yaw ? "position" : "distance", rules.delta_m);
  text += row(position_name, evaluation.relative_position_m, 1.0, "m");
  text += row(fmt::format("RPE yaw, {:g} m", rules.delta_m), evaluation.relative_yaw_rad,
              kDegPerRad, "deg");
  if (!evaluation.has_yaw) text += "one trajectory has no headings: yaw is not evaluated\n";
  return text;
}

std::string trajectory_json(const TrajectoryEvaluation& evaluation, const TrajectoryRules& rules) {
  constexpr const char* kAlignments[] = {"none", "rigid", "origin"};
  const geometry::Pose2& t = evaluation.T_truth_estimate;
  ordered_json json{{"num_estimates", evaluation.num_estimates},
                    {"num_true", evaluation.num_true},
                    {"num_compared", evaluation.compared.size()},
                    {"num_outside", evaluation.num_outside},
                    {"num_in_gaps", evaluation.num_in_gaps},
                    {"gap_max_s", evaluation.gap_max_s},
                    {"alignment", kAlignments[static_cast<std::size_t>(rules.alignment)]},
                    {"aligned_by", {{"x_m", t.x_m}, {"y_m", t.y_m}, {"yaw_rad", t.yaw_rad}}},
                    {"way_m", evaluation.compared.empty() ? 0.0 : evaluation.compared.back().way_m},
                    {"has_yaw", evaluation.has_yaw},
                    {"ape_position_m", statistics_json(evaluation.position_m)},
                    {"ape_yaw_rad", statistics_json(evaluation.yaw_rad)},
                    {"rpe_delta_m", rules.delta_m},
                    {"rpe_position_m", statistics_json(evaluation.relative_position_m)},
                    {"rpe_yaw_rad", statistics_json(evaluation.relative_yaw_rad)}};
  return json.dump(2) + "\n";
}

}  // namespace orchard::evaluation
