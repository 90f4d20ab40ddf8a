// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/detections/detection_evaluation.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "evaluation/map_evaluation.hpp"

namespace orchard::evaluation {
namespace {

using detection::Detection;
using detection::Label;

constexpr std::size_t kMaxCurvePoints = 400;

struct Scored {
  double score = 0.0;
  bool is_tree = false;
};

double mean(double sum, int num) { return num > 0 ? sum / num : 0.0; }

/// Probability that a tree scores higher than another object, ties counting half. `scored` is in
/// descending order.
double area_of(const std::vector<Scored>& scored) {
  double num_trees = 0, num_others = 0, above = 0;
  for (std::size_t i = 0; i < scored.size();) {
    double trees = 0, others = 0;
    const double score = scored[i].score;
    for (; i < scored.size() && scored[i].score == score; ++i) {
      (scored[i].is_tree ? trees : others) += 1;
    }
    above += others * (num_trees + 0.5 * trees);
    num_trees += trees;
    num_others += others;
  }
  return num_trees > 0 && num_others > 0 ? above / (num_trees * num_others) : 0.5;
}

void thin(std::vector<std::array<double, 2>>& curve) {
  if (curve.size() <= kMaxCurvePoints) return;
  std::vector<std::array<double, 2>> kept;
  for (std::size_t i = 0; i < kMaxCurvePoints; ++i) {
    kept.push_back(curve[i * (curve.size() - 1) / (kMaxCurvePoints - 1)]);
  }
  curve = std::move(kept);
}

ScoreTest run_test(const std::vector<ObservationPair>& observations, const DetectionRules& rules,
                   const char* name, const std::function<double(const Detection&)>& score_of) {
  ScoreTest test;
  test.name = name;
  std::vector<Scored> scored;
  int num_asked = 0;  // trees that count, detected or not
  int num_trees = 0, num_others = 0;
  for (const ObservationPair& observation : observations) {
    const bool asked = counts_as_tree(observation, rules);
    if (asked) ++num_asked;
    if (!observation.detection || observation.range_m() >= rules.range_max_m) continue;
    if (observation.is_tree() && !asked) continue;
    const double score = score_of(*observation.detection);
    scored.push_back({score, asked});
    (asked ? test.mean_of_trees : test.mean_of_others) += score;
    ++(asked ? num_trees : num_others);
  }
  test.mean_of_trees = mean(test.mean_of_trees, num_trees);
  test.mean_of_others = mean(test.mean_of_others, num_others);
  std::stable_sort(scored.begin(), scored.end(),
                   [](const Scored& a, const Scored& b) { return a.score > b.score; });
  test.area = area_of(scored);

  Counts running;
  double best_f1 = -1.0;
  for (std::size_t i = 0; i < scored.size() && scored[i].score > 0.0;) {
    const double threshold = scored[i].score;
    for (; i < scored.size() && scored[i].score == threshold; ++i) {
      ++(scored[i].is_tree ? running.num_right : running.num_wrong);
    }
    running.num_missed = num_asked - running.num_right;
    test.curve.push_back({running.recall(), running.precision()});
    if (running.f1() <= best_f1) continue;
    best_f1 = running.f1();
    test.best_threshold = threshold;
    test.best = running;
  }
  if (best_f1 < 0.0) test.best.num_missed = num_asked;
  thin(test.curve);
  return test;
}

}  // namespace

bool counts(const ObservationPair& observation, const DetectionRules& rules) {
  if (!observation.truth) return false;
  const simulation::TrueObservation& t = *observation.truth;
  return t.range_m < rules.range_max_m && t.num_beams >= rules.num_beams_min &&
         t.hidden_fraction <= rules.hidden_max &&
         (!rules.in_picture || (t.in_picture && observation.has_image));
}

bool counts_as_tree(const ObservationPair& observation, const DetectionRules& rules) {
  return observation.is_tree() && counts(observation, rules);
}

void count_observation(const ObservationPair& observation, bool is_called_tree,
                       const DetectionRules& rules, Counts& counts) {
  if (observation.is_tree()) {
    if (!counts_as_tree(observation, rules)) return;
    if (is_called_tree) {
      ++counts.num_right;
      return;
    }
    ++counts.num_missed;
    if (!observation.detection) ++counts.num_not_detected;
    if (observation.detection && observation.detection->label == Label::kUnseen)
      ++counts.num_unseen;
  } else if (is_called_tree && observation.range_m() < rules.range_max_m) {
    ++counts.num_wrong;
    if (observation.truth) ++counts.num_wrong_on_object;
  }
}

std::vector<ScoreTest> score_tests(const std::vector<ObservationPair>& observations,
                                   const DetectionRules& rules) {
  std::vector<ScoreTest> tests{
      run_test(observations, rules, "colour only", [](const Detection& d) { return d.roc_colour; }),
      run_test(observations, rules, "edges only", [](const Detection& d) { return d.roc_edges; }),
      run_test(observations, rules, "colour and edges",
               [](const Detection& d) { return d.roc_vision; }),
      run_test(observations, rules, "laser only", [](const Detection& d) { return d.roc_laser; }),
      run_test(observations, rules, "everything", [](const Detection& d) { return d.roc_tree; })};
  const bool has_probability =
      std::any_of(observations.begin(), observations.end(), [](const ObservationPair& observation) {
        return observation.detection && observation.detection->probability_tree > 0.0f;
      });
  if (has_probability) {
    tests.push_back(run_test(observations, rules, "probability",
                             [](const Detection& d) { return d.probability_tree; }));
  }
  return tests;
}

namespace {

using detection::Detection;
using detection::Label;

constexpr std::array<double, 9> kRangeEdgesM{0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0};

bool is_called_tree(const ObservationPair& observation) {
  return observation.detection && observation.detection->label == Label::kTree;
}

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

ErrorStatistics centre_errors(const std::vector<ObservationPair>& observations,
                              const DetectionRules& rules, double from_m, double to_m) {
  DetectionRules within = rules;
  within.range_max_m = to_m;
  std::vector<double> errors_m;
  for (const ObservationPair& observation : observations) {
    if (!is_called_tree(observation) || !observation.is_tree() ||
        !counts_as_tree(observation, within))
      continue;
    if (observation.truth->range_m >= from_m) errors_m.push_back(observation.centre_error_m);
  }
  return error_statistics(std::move(errors_m));
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
  std::vector<double> errors_m;
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
      errors_m.push_back(object.error_m);
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
  result.trees = error_statistics(std::move(errors_m));
  result.reliability = reliability(forecasts);
  if (forecasts_out) {
    forecasts_out->insert(forecasts_out->end(), forecasts.begin(), forecasts.end());
  }
  return result;
}

namespace {

using nlohmann::ordered_json;

ordered_json counts_json(const Counts& c) {
  return {{"precision", c.precision()},
          {"recall", c.recall()},
          {"f1", c.f1()},
          {"num_right", c.num_right},
          {"num_wrong", c.num_wrong},
          {"num_missed", c.num_missed},
          {"num_wrong_on_object", c.num_wrong_on_object},
          {"num_unseen", c.num_unseen},
          {"num_not_detected", c.num_not_detected}};
}

ordered_json reliability_json(const Reliability& r) {
  ordered_json json{{"expected_calibration_error", r.expected_calibration_error},
                    {"brier_score", r.brier_score},
                    {"num", r.num},
                    {"bins", ordered_json::array()}};
  for (const ReliabilityBin& bin : r.bins) {
    json["bins"].push_back({{"from", bin.from},
                            {"to", bin.to},
                            {"num", bin.num},
                            {"mean_probability", bin.mean_probability},
                            {"frequency", bin.frequency}});
  }
  return json;
}

ordered_json slices_json(const std::vector<Slice>& slices) {
  ordered_json list = ordered_json::array();
  for (const Slice& slice : slices) {
    ordered_json json = counts_json(slice.counts);
    json["name"] = slice.name;
    json["from_m"] = slice.from_m;
    json["to_m"] = slice.to_m;
    json["centre_error"] = errors_json<ordered_json>(slice.centre);
    list.push_back(std::move(json));
  }
  return list;
}

ordered_json test_json(const ScoreTest& test) {
  return {{"name", test.name},
          {"mean_of_trees", test.mean_of_trees},
          {"mean_of_others", test.mean_of_others},
          {"area", test.area},
          {"best_threshold", test.best_threshold},
          {"best", counts_json(test.best)},
          {"recall_precision", test.curve}};
}

}  // namespace

std::string detection_json(const DetectionEvaluation& e) {
  ordered_json json{{"range_max_m", e.rules.range_max_m},
                    {"num_beams_min", e.rules.num_beams_min},
                    {"hidden_max", e.rules.hidden_max},
                    {"in_picture", e.rules.in_picture},
                    {"gate_m", e.rules.gate_m},
                    {"num_scans", e.num_scans},
                    {"num_looks", e.num_observations},
                    {"observations", counts_json(e.counts)},
                    {"by_range", slices_json(e.by_range)},
                    {"by_recording", slices_json(e.by_recording)},
                    {"tests", ordered_json::array()}};
  for (const ScoreTest& test : e.tests) json["tests"].push_back(test_json(test));
  if (e.has_probability) json["probability"] = reliability_json(e.reliability);
  if (e.landmarks) {
    json["landmarks"] = counts_json(e.landmarks->counts);
    json["landmarks"]["centre_error"] = errors_json<ordered_json>(e.landmarks->trees);
    json["landmarks"]["probability"] = reliability_json(e.landmarks->reliability);
  }
  return json.dump(2) + "\n";
}

}  // namespace orchard::evaluation
