// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/trunk_selection.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <utility>

#include "calibration/tuning.hpp"
#include "geometry/angles.hpp"
#include "geometry/statistics.hpp"
#include "vision/appearance.hpp"

namespace orchard::calibration {
namespace {

// derived: budget; more of one object say little that is new.
constexpr std::size_t kMaxObservations = 12;  // per object

/// Selects at most kMaxObservations of an object's observations, evenly spread.
std::vector<std::size_t> spread(const std::vector<std::size_t>& observations) {
  if (observations.size() <= kMaxObservations) return observations;
  std::vector<std::size_t> some;
  for (std::size_t i = 0; i < kMaxObservations; ++i)
    some.push_back(observations[i * observations.size() / kMaxObservations]);
  return some;
}

/// The windows of the model's objects, and which of them lie on an object and which beside it.
struct TrunkWindows {
  std::vector<AppearanceSample> samples;
  std::vector<char> is_on;
  std::vector<const WindowObservation*> windows;
};

TrunkWindows windows_of(const std::vector<TrunkObservation>& observations,
                        const TrunkModel& model) {
  TrunkWindows all;
  const auto take = [&](const WindowObservation& window, bool is_trunk, bool is_on, int group) {
    all.samples.push_back({window.features, is_trunk, group});
    all.is_on.push_back(is_on);
    all.windows.push_back(&window);
  };
  for (std::size_t object = 0; object < model.objects.size(); ++object) {
    const ObservedObject& seen = model.objects[object];
    if (seen.is_doubtful) continue;
    for (const std::size_t i : spread(seen.observations)) {
      for (const auto& window : observations[i].on)
        take(window, seen.is_trunk, true, static_cast<int>(object));
      if (!seen.is_trunk) continue;
      for (const auto& window : observations[i].beside)
        take(window, false, false, static_cast<int>(object));
    }
  }
  return all;
}

}  // namespace

TrunkAppearance learn_trunk_appearance(const std::vector<TrunkObservation>& observations,
                                       const TrunkModel& model,
                                       const vision::ColourConfig& colour) {
  vision::ColourConfig interval = colour;
  interval.hue_min_deg = model.hue_min_deg;
  interval.hue_max_deg = model.hue_max_deg;
  const TrunkWindows all = windows_of(observations, model);
  std::vector<double> hue_trunk, hue_other;
  for (std::size_t i = 0; i < all.samples.size(); ++i) {
    const double roc = vision::colour_confidence(all.windows[i]->hues, interval).roc;
    (all.samples[i].is_trunk ? hue_trunk : hue_other).push_back(roc);
  }
  return {learn_appearance(all.samples), geometry::roc_area(hue_trunk, hue_other)};
}

std::vector<std::optional<double>> trunk_scores(const std::vector<TrunkObservation>& observations,
                                                const TrunkModel& model) {
  const TrunkWindows all = windows_of(observations, model);
  const AppearanceFit fit = learn_appearance(all.samples);
  std::vector<double> sums(model.objects.size()), numbers(model.objects.size());
  const auto add = [&](std::size_t object, double log_odds) {
    sums[object] += log_odds;
    numbers[object] += 1.0;
  };
  for (std::size_t i = 0; i < all.samples.size(); ++i) {
    if (!all.is_on[i]) continue;
    const auto object = static_cast<std::size_t>(all.samples[i].group);
    if (!std::isnan(fit.left_out[i])) add(object, fit.left_out[i]);
  }
  for (std::size_t object = 0; object < model.objects.size(); ++object) {
    if (!model.objects[object].is_doubtful) continue;
    for (const std::size_t i : spread(model.objects[object].observations)) {
      for (const WindowObservation& window : observations[i].on)
        add(object, vision::appearance_log_odds(window.features, fit.config));
    }
  }
  std::vector<std::optional<double>> scores(model.objects.size());
  for (std::size_t object = 0; object < scores.size(); ++object) {
    if (numbers[object] > 0.0) scores[object] = sums[object] / numbers[object];
  }
  return scores;
}

namespace {

// derived: 3 sigma.
/// Widths of trees reach farther than the trunks that were chosen within width_spread: objects
/// within so many standard deviations of the chosen trunks may be trunks, too.
constexpr double kReach_sigma = 3.0;

/// Largest difference from the mean width with which an object may be a trunk [m].
double reach_m(const TrunkModel& model) {
  double squares_m2 = 0.0;
  for (const ObservedObject& seen : model.objects) {
    if (seen.is_trunk) squares_m2 += geometry::square(seen.median_width_m - model.width_mean_m);
  }
  return std::max(model.width_spread * model.width_mean_m,
                  kReach_sigma * std::sqrt(squares_m2 / std::max(1, model.num_trunks)));
}

/// RMS distance of an object's observations from their mean [m].
double scatter_m(const ObservedObject& seen, const std::vector<TrunkObservation>& observations) {
  double x_m = 0.0, y_m = 0.0, squares_m2 = 0.0;
  const auto n = static_cast<double>(std::max<std::size_t>(1, seen.observations.size()));
  for (const std::size_t i : seen.observations) {
    x_m += observations[i].x_m / n;
    y_m += observations[i].y_m / n;
  }
  for (const std::size_t i : seen.observations) {
    squares_m2 += geometry::square(observations[i].x_m - x_m);
    squares_m2 += geometry::square(observations[i].y_m - y_m);
  }
  return std::sqrt(squares_m2 / n);
}

/// Scatter from which on an object walks [m].
double walks_from_m(const TrunkModel& model, const std::vector<TrunkObservation>& observations) {
  std::vector<double> of_trunks_m;
  for (const ObservedObject& seen : model.objects) {
    if (seen.is_trunk) of_trunks_m.push_back(scatter_m(seen, observations));
  }
  return of_trunks_m.empty() ? 0.0
                             : tuning::kWalkingFactor * geometry::median(std::move(of_trunks_m));
}

/// What width and movement say of an object.
enum class Reach {
  kChosen,    ///< a trunk of the first model
  kPossible,  ///< as wide as a trunk may be, and does not move
  kOutside,   ///< too wide or too thin
  kWalks,
};

std::vector<Reach> reach_of_objects(const TrunkModel& model,
                                    const std::vector<TrunkObservation>& observations) {
  const double limit_m = reach_m(model), walks_m = walks_from_m(model, observations);
  std::vector<Reach> reach;
  for (const ObservedObject& seen : model.objects) {
    const bool near = std::abs(seen.median_width_m - model.width_mean_m) <= limit_m;
    reach.push_back(seen.is_trunk                              ? Reach::kChosen
                    : scatter_m(seen, observations) >= walks_m ? Reach::kWalks
                    : near                                     ? Reach::kPossible
                                                               : Reach::kOutside);
  }
  return reach;
}

/// What another object of a class scores, by those seen so far: Student's t, which few objects make
/// wide. Source: Gelman et al., Bayesian Data Analysis, 2013, section 3.2.
class Scores {
 public:
  explicit Scores(const std::vector<double>& scores) : n_(static_cast<double>(scores.size())) {
    double squares = 0.0;
    for (const double score : scores) mean_ += score / n_;
    for (const double score : scores) squares += geometry::square(score - mean_);
    if (n_ > 1.0) scale_ = std::sqrt(squares / (n_ - 1.0) * (1.0 + 1.0 / n_));
  }
  bool known() const { return scale_ > 0.0; }
  double mean() const { return mean_; }
  double log_density(double score) const {
    const double freedom = n_ - 1.0, z = (score - mean_) / scale_;
    return std::lgamma(0.5 * (freedom + 1.0)) - std::lgamma(0.5 * freedom) -
           0.5 * std::log(freedom * geometry::kPi) - std::log(scale_) -
           0.5 * (freedom + 1.0) * std::log1p(z * z / freedom);
  }

 private:
  double n_, mean_ = 0.0, scale_ = 0.0;
};

/// Scores of what the first model took for trunks, and of what is no trunk by its width. These
/// objects stay the same in all rounds, so that the border between both does not drift.
struct ScoresOfClasses {
  Scores trunks, others;

  bool separate() const {
    return trunks.known() && others.known() && trunks.mean() > others.mean();
  }
  /// Probability that an object is a trunk, for equal priors. Beyond the mean of its class a score
  /// says no more than at the mean.
  double probability(double score) const {
    const double log_odds = trunks.log_density(std::min(score, trunks.mean())) -
                            others.log_density(std::max(score, others.mean()));
    return 1.0 / (1.0 + std::exp(-log_odds));
  }
};

ScoresOfClasses scores_of_classes(const std::vector<Reach>& reach,
                                  const std::vector<std::optional<double>>& scores) {
  std::vector<double> of[2];
  for (std::size_t i = 0; i < reach.size(); ++i) {
    if (!scores[i]) continue;
    if (reach[i] == Reach::kChosen) of[0].push_back(*scores[i]);
    if (reach[i] == Reach::kOutside) of[1].push_back(*scores[i]);
  }
  return {Scores(of[0]), Scores(of[1])};
}

/// Judges the objects within reach by the looks of the model's present trunks; those that `is_kept`
/// stay trunks. Empty if looks do not separate trunks from anything else.
std::optional<TrunkModel> judge(const std::vector<TrunkObservation>& observations,
                                const std::vector<Reach>& reach, const std::vector<bool>& is_kept,
                                const TrunkModel& model, TrunkModelOptions options) {
  const auto scores = trunk_scores(observations, model);
  const ScoresOfClasses classes = scores_of_classes(reach, scores);
  if (!classes.separate()) return std::nullopt;
  options.judged.clear();
  std::vector<bool> is_doubtful(reach.size());
  for (std::size_t i = 0; i < reach.size(); ++i) {
    if (reach[i] == Reach::kOutside || reach[i] == Reach::kWalks) continue;
    const double probability = scores[i] ? classes.probability(*scores[i]) : 0.5;
    const bool is_enough = model.objects[i].num_observations >= options.min_observations;
    if (is_kept[i] || (is_enough && probability > 0.5)) {
      options.judged.push_back(i);
    } else {
      is_doubtful[i] = probability > tuning::kSurelyNone;
    }
  }
  if (options.judged.empty()) return std::nullopt;
  TrunkModel next = estimate_trunk_model(observations, options);
  for (std::size_t i = 0; i < reach.size(); ++i) next.objects[i].is_doubtful = is_doubtful[i];
  return next;
}

std::vector<bool> trunks_of(const TrunkModel& model) {
  std::vector<bool> trunks;
  for (const ObservedObject& seen : model.objects) trunks.push_back(seen.is_trunk);
  return trunks;
}

}  // namespace

TrunkModel select_trunks(const std::vector<TrunkObservation>& observations, const TrunkModel& model,
                         const TrunkModelOptions& options) {
  if (model.is_picked || !model.has_hue) return model;
  const std::vector<Reach> reach = reach_of_objects(model, observations);
  TrunkModel now = model;
  for (std::size_t i = 0; i < reach.size(); ++i)
    now.objects[i].is_doubtful = reach[i] == Reach::kPossible;
  std::vector<bool> is_kept(reach.size());  // none in the first round
  try {
    while (true) {  // each round but the first adds at least one object
      auto next = judge(observations, reach, is_kept, now, options);
      if (!next) break;
      const std::vector<bool> trunks = trunks_of(*next);
      now = std::move(*next);
      if (trunks == is_kept) break;
      is_kept = trunks;
    }
  } catch (const std::runtime_error&) {
    return now;  // too few windows to learn from
  }
  return now;
}

}  // namespace orchard::calibration
