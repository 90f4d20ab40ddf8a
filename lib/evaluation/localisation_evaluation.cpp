// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/localisation_evaluation.hpp"

#include <fmt/core.h>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "geometry/angles.hpp"
#include "geometry/statistics.hpp"
#include "geometry/symmetric.hpp"

namespace orchard::evaluation {
namespace {

constexpr std::array<double, 3> kLimits_m{0.1, 0.3, 0.5};
constexpr double kWrong_m = kLimits_m.back();
/// derived: 95 % quantile of the chi-square distribution of 2 degrees of freedom, -2 ln(0.05).
constexpr double kChiSquare2_95 = 5.991;
constexpr double kAnyGap_s = 1e9;  ///< derived: longer than any drive
/// physical: a receiver that is silent for longer has lost its fix; what was driven is unknown.
constexpr double kTruthGap_s = 10.0;

PlaceState state_at(const std::vector<PlaceStateChange>& states, std::int64_t utime) {
  const auto after = std::upper_bound(
      states.begin(), states.end(), utime,
      [](std::int64_t t, const PlaceStateChange& change) { return t < change.utime; });
  return after == states.begin() ? PlaceState::kLost : std::prev(after)->state;
}

/// The covariance of the position claimed by the pose before or at a time.
Eigen::Matrix2d covariance_at(const std::vector<pose::PoseEstimate>& poses, std::int64_t utime) {
  auto after = std::upper_bound(
      poses.begin(), poses.end(), utime,
      [](std::int64_t t, const pose::PoseEstimate& pose) { return t < pose.utime; });
  if (after != poses.begin()) --after;
  const auto& c = after->covariance;
  return (Eigen::Matrix2d() << c[0], c[1], c[1], c[3]).finished();
}

Track track_of(const std::vector<pose::PoseEstimate>& poses) {
  Track track;
  for (const pose::PoseEstimate& p : poses) {
    track.poses.push_back({p.utime, p.x_m, p.y_m, p.yaw_rad});
  }
  return track;
}

/// A stretch of steps that all hold.
class Stretch {
 public:
  void add(bool holds, double time_s, double way_m) {
    time_s_ = holds ? time_s_ + time_s : 0.0;
    way_m_ = holds ? way_m_ + way_m : 0.0;
    longest_s = std::max(longest_s, time_s_);
    longest_m = std::max(longest_m, way_m_);
    if (!holds) return;
    all_s += time_s;
    all_m += way_m;
  }

  double all_s = 0.0, all_m = 0.0, longest_s = 0.0, longest_m = 0.0;

 private:
  double time_s_ = 0.0, way_m_ = 0.0;
};

}  // namespace

LocalisationEvaluation evaluate_localisation(const ShadowRun& run, const Track& truth,
                                             double truth_sd_m) {
  if (truth.poses.size() < 2) {
    throw std::invalid_argument("evaluate_localisation: fewer than two true poses");
  }
  if (!(truth_sd_m >= 0.0)) {
    throw std::invalid_argument(
        "evaluate_localisation: the truth's standard deviation is negative");
  }
  // The run at the times of the truth: roles are exchanged. Where it has no pose, its states tell.
  TrajectoryRules rules;
  rules.gap_max_s = kAnyGap_s;
  const TrajectoryEvaluation at_truth = evaluate_trajectory(truth, track_of(run.poses), rules);
  LocalisationEvaluation e;
  std::array<Stretch, kLimits_m.size()> within;
  Stretch placed, wrong;
  std::vector<double> errors_m, turns_rad, nees;
  double variance_sum_m2 = 0.0;
  auto pair = at_truth.compared.begin();
  for (std::size_t i = 0; i < truth.poses.size(); ++i) {
    const TrackPose& now = truth.poses[i];
    double step_s = 0.0, step_m = 0.0;
    if (i > 0) {
      const TrackPose& before = truth.poses[i - 1];
      const double since_s = 1e-6 * static_cast<double>(now.utime - before.utime);
      if (since_s <= kTruthGap_s) {
        step_s = since_s;
        step_m = std::hypot(now.x_m - before.x_m, now.y_m - before.y_m);
      }
    }
    e.time_s += step_s;
    e.way_m += step_m;
    ShadowMoment moment{1e-6 * static_cast<double>(now.utime - truth.poses.front().utime), e.way_m,
                        state_at(run.states, now.utime), std::nullopt, 0.0};
    bool is_wrong = false;
    const bool is_known = pair != at_truth.compared.end() && pair->utime == now.utime;
    const bool is_told = moment.state == PlaceState::kPlaced;
    const bool has_pose = is_known && (is_told || moment.state == PlaceState::kUnconfirmed);
    if (has_pose) {
      const Eigen::Vector2d error(pair->truth.x_m - now.x_m, pair->truth.y_m - now.y_m);
      const Eigen::Matrix2d claimed = covariance_at(run.poses, now.utime);
      const Eigen::Matrix2d both =
          claimed + geometry::square(truth_sd_m) * Eigen::Matrix2d::Identity();
      const double d2 = both.determinant() > 0.0 ? error.dot(both.inverse() * error) : 0.0;
      moment.error_m = error.norm();
      moment.sd_m = std::sqrt(std::max(0.0, geometry::axes_of(claimed).values.y()));
      variance_sum_m2 += claimed.trace();
      nees.push_back(d2);
      errors_m.push_back(error.norm());
      if (truth.has_yaw) turns_rad.push_back(std::abs(pair->yaw_error_rad));
      is_wrong = is_told && error.norm() > kWrong_m && d2 > geometry::kChiSquare2_997;
      if (!e.first_s) e.first_s = moment.time_s, e.first_m = moment.way_m;
    }
    if (is_known) ++pair;
    // After its last pose a run that claims a place has none, either.
    if (moment.state >= PlaceState::kUnconfirmed && !has_pose) moment.state = PlaceState::kLost;
    if (moment.state == PlaceState::kLost) e.lost_s += step_s;
    if (moment.state == PlaceState::kAmbiguous) e.ambiguous_s += step_s;
    if (moment.state == PlaceState::kUnconfirmed) e.unconfirmed_s += step_s;
    placed.add(has_pose, step_s, step_m);
    wrong.add(is_wrong, step_s, step_m);
    for (std::size_t k = 0; k < kLimits_m.size(); ++k) {
      within[k].add(has_pose && *moment.error_m <= kLimits_m[k], step_s, step_m);
    }
    e.moments.push_back(moment);
  }
  for (std::size_t k = 0; k < kLimits_m.size(); ++k) {
    const Stretch& s = within[k];
    e.within[k] = {kLimits_m[k], s.all_s, s.all_m, s.longest_s, s.longest_m};
  }
  e.placed_s = placed.all_s;
  e.placed_m = placed.all_m;
  e.wrong_s = wrong.all_s;
  e.wrong_m = wrong.all_m;
  e.wrong_longest_s = wrong.longest_s;
  if (!nees.empty()) {
    const auto n = static_cast<double>(nees.size());
    e.sd_m = std::sqrt(variance_sum_m2 / n);
    e.nees_share = static_cast<double>(std::count_if(
                       nees.begin(), nees.end(), [](double d2) { return d2 <= kChiSquare2_95; })) /
                   n;
    e.nees = error_statistics(std::move(nees)).mean;
  }
  e.position_m = error_statistics(std::move(errors_m));
  e.yaw_rad = error_statistics(std::move(turns_rad));
  return e;
}

namespace {

double share(double part, double all) { return all > 0.0 ? part / all : 0.0; }

const char* word_of(PlaceState state) {
  constexpr std::array<const char*, 4> kWords{"lost", "ambiguous", "unconfirmed", "placed"};
  return kWords[static_cast<std::size_t>(state)];
}

}  // namespace

std::string localisation_summary(const LocalisationEvaluation& e) {
  std::string text = fmt::format(
      "drive: {:.1f} s, {:.1f} m by the truth; with a pose {:.1f} % of the time and {:.1f} % of "
      "the "
      "way\nLOST {:.1f} s, AMBIGUOUS {:.1f} s, UNCONFIRMED {:.1f} s; ",
      e.time_s, e.way_m, 100.0 * share(e.placed_s, e.time_s), 100.0 * share(e.placed_m, e.way_m),
      e.lost_s, e.ambiguous_s, e.unconfirmed_s);
  if (!e.first_s) return text + "no pose at all\n";
  text += fmt::format("first pose after {:.1f} s, {:.1f} m\n", *e.first_s, *e.first_m);
  text += fmt::format("error with a pose: RMS {:.3f}, median {:.3f}, most {:.3f} m",
                      e.position_m.rmse, e.position_m.median, e.position_m.max);
  if (e.yaw_rad.num > 0) {
    text += fmt::format("; heading RMS {:.2f} degrees", e.yaw_rad.rmse * 180.0 / geometry::kPi);
  }
  text += "\n";
  for (const DrivenWithin& w : e.within) {
    text += fmt::format(
        "within {:.1f} m: {:5.1f} % of the time, {:5.1f} % of the way; without a break {:.1f} s, "
        "{:.1f} m\n",
        w.limit_m, 100.0 * share(w.time_s, e.time_s), 100.0 * share(w.way_m, e.way_m), w.longest_s,
        w.longest_m);
  }
  return text +
         fmt::format(
             "wrong without a warning (over {:.1f} m and more than claimed): {:.1f} s, {:.1f} m; "
             "longest {:.1f} s\nclaimed sd RMS {:.3f} m; NEES of the position {:.1f} (2 if the "
             "claims "
             "are true), {:.0f} % within 95 %\n",
             kWrong_m, e.wrong_s, e.wrong_m, e.wrong_longest_s, e.sd_m, e.nees,
             100.0 * e.nees_share);
}

std::string localisation_json(const LocalisationEvaluation& e) {
  using nlohmann::ordered_json;
  ordered_json within = ordered_json::array();
  for (const DrivenWithin& w : e.within) {
    within.push_back({{"limit_m", w.limit_m},
                      {"time_share", share(w.time_s, e.time_s)},
                      {"way_share", share(w.way_m, e.way_m)},
                      {"longest_s", w.longest_s},
                      {"longest_m", w.longest_m}});
  }
  const auto known = [](const std::optional<double>& value) {
    return value ? ordered_json(*value) : ordered_json(nullptr);
  };
  const ordered_json json{{"time_s", e.time_s},
                          {"way_m", e.way_m},
                          {"placed_time_share", share(e.placed_s, e.time_s)},
                          {"placed_way_share", share(e.placed_m, e.way_m)},
                          {"lost_s", e.lost_s},
                          {"ambiguous_s", e.ambiguous_s},
                          {"unconfirmed_s", e.unconfirmed_s},
                          {"first_pose_s", known(e.first_s)},
                          {"first_pose_m", known(e.first_m)},
                          {"position_rms_m", e.position_m.rmse},
                          {"position_median_m", e.position_m.median},
                          {"position_max_m", e.position_m.max},
                          {"yaw_rms_rad", e.yaw_rad.rmse},
                          {"within", within},
                          {"wrong_s", e.wrong_s},
                          {"wrong_m", e.wrong_m},
                          {"wrong_longest_s", e.wrong_longest_s},
                          {"claimed_sd_m", e.sd_m},
                          {"nees", e.nees},
                          {"nees_share_within_95", e.nees_share}};
  return json.dump(2) + "\n";
}

std::string localisation_csv(const LocalisationEvaluation& e) {
  std::string text = "time_s,way_m,state,error_m,sd_m\n";
  for (const ShadowMoment& m : e.moments) {
    text += fmt::format("{:.3f},{:.3f},{},", m.time_s, m.way_m, word_of(m.state));
    text += m.error_m ? fmt::format("{:.4f},{:.4f}\n", *m.error_m, m.sd_m) : ",\n";
  }
  return text;
}

}  // namespace orchard::evaluation
