// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/detections/observation_pair.hpp"
#include "evaluation/detections/reliability.hpp"
#include "evaluation/map_evaluation.hpp"

namespace orchard::evaluation {

/// Which observations count. What does not count is neither found nor missed; see RULES.md.
struct DetectionRules {
  double range_max_m = 4.0;  ///< farther things do not count
  int num_beams_min = 3;     ///< fewer beams on a thing: too little to ask for
  double hidden_max = 0.3;   ///< fraction of it behind nearer things
  bool in_picture = true;    ///< only what the camera has in full; false for a rig without one
  double gate_m = 0.3;       ///< farthest a detected centre lies from the true axis
};

/// Found, invented and missed trees.
struct Counts {
  int num_right = 0;            ///< trees called TREE
  int num_wrong = 0;            ///< called TREE without being one
  int num_missed = 0;           ///< trees that count, not called TREE
  int num_wrong_on_object = 0;  ///< part of num_wrong: on a thing that is none
  int num_unseen = 0;           ///< part of num_missed: detected, but UNSEEN
  int num_not_detected = 0;     ///< part of num_missed: nothing there at all

  double precision() const;  ///< 1 when nothing was called TREE
  double recall() const;     ///< 1 when no tree counts
  double f1() const;         ///< 2 right / (2 right + wrong + missed); 1 when all three are 0
};

/// One stretch of range, or one recording.
struct Slice {
  std::string name;
  double from_m = 0.0;
  double to_m = 0.0;
  Counts counts;
  ErrorSummary centre;  ///< of the trees called TREE
};

/// A decision by one rate of confidence alone, at every threshold.
struct ScoreTest {
  std::string name;            ///< "colour only"
  double mean_of_trees = 0.0;  ///< over the trees that count and are detected; section 6.2
  double mean_of_others = 0.0;
  double area = 0.5;            ///< under the ROC curve, of what was detected
  double best_threshold = 0.0;  ///< largest F1 on these very observations
  Counts best;
  std::vector<std::array<double, 2>> curve;  ///< recall, precision; threshold falling
};

/// Landmarks of class tree against the trees of the truth.
struct LandmarkEvaluation {
  Counts counts;
  Reliability reliability;  ///< of `probability`, of all landmarks but the unseen
  ErrorSummary trees;
  int num_trees = 0;
};

struct DetectionEvaluation {
  DetectionRules rules;
  int num_scans = 0;
  int num_observations = 0;  ///< detections and true things, paired or not
  Counts counts;             ///< of the labels as sent
  std::vector<Slice> by_range;
  std::vector<Slice> by_recording;
  std::vector<ScoreTest> tests;
  bool has_probability = false;
  Reliability reliability;  ///< of probability_tree, of all detections that something judged
  std::optional<LandmarkEvaluation> landmarks;
};

/// Precision, recall and F1 of class tree per observation, by range and by recording; the paper's
/// three tests and more; and whether probability_tree means what it says. `names` are the
/// recordings'.
DetectionEvaluation evaluate_detections(const std::vector<ObservationPair>& observations,
                                        const std::vector<std::string>& names,
                                        const DetectionRules& rules);

/// Counts alone of the looks for which a score reaches a threshold, instead of their labels.
Counts count_labels(const std::vector<ObservationPair>& observations, const DetectionRules& rules);

/// Root mean square centre error of trees called TREE between two ranges [m]; n in `num`.
ErrorSummary centre_errors(const std::vector<ObservationPair>& observations,
                           const DetectionRules& rules, double from_m, double to_m);

/// Forecasts of the detections that something judged: probability_tree, and whether it was a tree.
std::vector<Forecast> forecasts_of(const std::vector<ObservationPair>& observations);

/// Landmarks against all the truth; those that no observation of a recording counted do not count
/// when `was_observed` (by place in the truth) says so.
LandmarkEvaluation evaluate_landmarks(const std::vector<mapping::Landmark>& landmarks,
                                      const std::vector<simulation::TruthObject>& truth,
                                      const std::vector<bool>& was_observed, double gate_m,
                                      std::vector<Forecast>* forecasts = nullptr);

/// Of each thing of the truth, whether an observation counted it.
std::vector<bool> was_observed(const std::vector<ObservationPair>& observations,
                               std::size_t num_things, const DetectionRules& rules);

/// Sums.
Counts& operator+=(Counts& into, const Counts& more);

}  // namespace orchard::evaluation
