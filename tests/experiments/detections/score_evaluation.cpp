// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/detections/score_evaluation.hpp"

#include <algorithm>
#include <functional>

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

}  // namespace orchard::evaluation
