// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/detections/detection_evaluation.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <array>
#include <cmath>

#include "experiments/detections/score_evaluation.hpp"

namespace orchard::evaluation {
namespace {

using detection::Detection;
using detection::Label;

constexpr std::array<double, 9> kRangeEdgesM{0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0};

bool is_called_tree(const ObservationPair& observation) {
  return observation.detection && observation.detection->label == Label::kTree;
}

class ErrorSum {
 public:
  void add(double error_m) {
    ++sum_.num;
    sum_.mean_m += error_m;
    sum_.rms_m += error_m * error_m;
    sum_.max_m = std::max(sum_.max_m, error_m);
  }
  ErrorSummary summary() const {
    ErrorSummary result = sum_;
    if (result.num == 0) return result;
    result.mean_m /= result.num;
    result.rms_m = std::sqrt(result.rms_m / result.num);
    return result;
  }

 private:
  ErrorSummary sum_;
};

Slice slice_of(const std::vector<ObservationPair>& observations, DetectionRules rules,
               const std::string& name, double from_m, double to_m) {
  Slice slice;
  slice.name = name;
  slice.from_m = from_m;
  slice.to_m = to_m;
  rules.range_max_m = to_m;
  std::vector<ObservationPair> inside;
  for (const ObservationPair& observation : observations) {
    if (observation.range_m() >= from_m && observation.range_m() < to_m)
      inside.push_back(observation);
  }
  slice.counts = count_labels(inside, rules);
  slice.centre = centre_errors(inside, rules, from_m, to_m);
  return slice;
}

}  // namespace

double Counts::precision() const {
  const int called = num_right + num_wrong;
  return called > 0 ? static_cast<double>(num_right) / called : 1.0;
}

double Counts::recall() const {
  const int trees = num_right + num_missed;
  return trees > 0 ? static_cast<double>(num_right) / trees : 1.0;
}

double Counts::f1() const {
  const int all = 2 * num_right + num_wrong + num_missed;
  return all > 0 ? 2.0 * num_right / all : 1.0;
}

Counts& operator+=(Counts& into, const Counts& more) {
  into.num_right += more.num_right;
  into.num_wrong += more.num_wrong;
  into.num_missed += more.num_missed;
  into.num_wrong_on_object += more.num_wrong_on_object;
  into.num_unseen += more.num_unseen;
  into.num_not_detected += more.num_not_detected;
  return into;
}

Counts count_labels(const std::vector<ObservationPair>& observations, const DetectionRules& rules) {
  Counts counts;
  for (const ObservationPair& observation : observations)
    count_observation(observation, is_called_tree(observation), rules, counts);
  return counts;
}

ErrorSummary centre_errors(const std::vector<ObservationPair>& observations,
                           const DetectionRules& rules, double from_m, double to_m) {
  DetectionRules within = rules;
  within.range_max_m = to_m;
  ErrorSum sum;
  for (const ObservationPair& observation : observations) {
    if (!is_called_tree(observation) || !observation.is_tree() ||
        !counts_as_tree(observation, within))
      continue;
    if (observation.truth->range_m >= from_m) sum.add(observation.centre_error_m);
  }
  return sum.summary();
}

std::vector<Forecast> forecasts_of(const std::vector<ObservationPair>& observations) {
  std::vector<Forecast> forecasts;
  for (const ObservationPair& observation : observations) {
    if (!observation.detection) continue;
    const Detection& d = *observation.detection;
    if (d.probability_tree + d.probability_object <= 0.0f) continue;
    forecasts.push_back({std::clamp<double>(d.probability_tree, 0.0, 1.0), observation.is_tree()});
  }
  return forecasts;
}

DetectionEvaluation evaluate_detections(const std::vector<ObservationPair>& observations,
                                        const std::vector<std::string>& names,
                                        const DetectionRules& rules) {
  DetectionEvaluation evaluation;
  evaluation.rules = rules;
  evaluation.num_observations = static_cast<int>(observations.size());
  evaluation.counts = count_labels(observations, rules);
  for (std::size_t i = 0; i + 1 < kRangeEdgesM.size(); ++i) {
    const std::string name =
        fmt::format("{:.0f} to {:.0f} m", kRangeEdgesM[i], kRangeEdgesM[i + 1]);
    Slice slice = slice_of(observations, rules, name, kRangeEdgesM[i], kRangeEdgesM[i + 1]);
    const Counts& c = slice.counts;
    if (c.num_right + c.num_wrong + c.num_missed > 0) {
      evaluation.by_range.push_back(std::move(slice));
    }
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::vector<ObservationPair> own;
    for (const ObservationPair& observation : observations) {
      if (observation.recording == static_cast<int>(i)) own.push_back(observation);
    }
    evaluation.by_recording.push_back(slice_of(own, rules, names[i], 0.0, rules.range_max_m));
  }
  evaluation.tests = score_tests(observations, rules);
  const auto forecasts = forecasts_of(observations);
  evaluation.has_probability = !forecasts.empty();
  evaluation.reliability = reliability(forecasts);
  return evaluation;
}

std::vector<bool> was_observed(const std::vector<ObservationPair>& observations,
                               std::size_t num_objects, const DetectionRules& rules) {
  std::vector<bool> result(num_objects, false);
  for (const ObservationPair& observation : observations) {
    if (!observation.truth || observation.truth->object < 0 || !counts(observation, rules))
      continue;
    const auto object = static_cast<std::size_t>(observation.truth->object);
    if (object < num_objects) result[object] = true;
  }
  return result;
}

LandmarkEvaluation evaluate_landmarks(const std::vector<mapping::Landmark>& landmarks,
                                      const std::vector<simulation::TruthObject>& truth,
                                      const std::vector<bool>& is_looked_at, double gate_m,
                                      std::vector<Forecast>* forecasts_out) {
  LandmarkEvaluation result;
  const MapEvaluation map = evaluate_map(landmarks, truth, gate_m);
  std::vector<Forecast> forecasts;
  ErrorSum errors;
  const auto forecast = [&](const mapping::Landmark& l, bool is_tree) {
    if (l.label != Label::kUnseen) forecasts.push_back({l.probability, is_tree});
  };
  for (std::size_t i = 0; i < map.objects.size(); ++i) {
    const EvaluatedObject& object = map.objects[i];
    const bool is_tree = object.truth.label == Label::kTree;
    const bool called = object.landmark && object.landmark->label == Label::kTree;
    if (object.landmark) forecast(*object.landmark, is_tree);
    if (is_tree && called) {
      ++result.num_trees;
      ++result.counts.num_right;
      errors.add(object.error_m);
    } else if (is_tree && (i >= is_looked_at.size() || is_looked_at[i])) {
      ++result.num_trees;
      ++result.counts.num_missed;
      if (!object.landmark) ++result.counts.num_not_detected;
      if (object.landmark && object.landmark->label == Label::kUnseen) ++result.counts.num_unseen;
    } else if (!is_tree && called) {
      ++result.counts.num_wrong;
      ++result.counts.num_wrong_on_object;
    }
  }
  for (const mapping::Landmark& l : map.extra) {
    forecast(l, false);
    if (l.label == Label::kTree) ++result.counts.num_wrong;
  }
  result.trees = errors.summary();
  result.reliability = reliability(forecasts);
  if (forecasts_out) {
    forecasts_out->insert(forecasts_out->end(), forecasts.begin(), forecasts.end());
  }
  return result;
}

}  // namespace orchard::evaluation
