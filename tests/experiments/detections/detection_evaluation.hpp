// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/map_evaluation.hpp"
#include "experiments/detections/reliability.hpp"
#include "worlds/observation_pair.hpp"

namespace orchard::evaluation {

/// Rules for the observations that count. An observation that does not count is neither found nor
/// missed; see RULES.md.
struct DetectionRules {
  double range_max_m = 4.0;  ///< max range
  int num_beams_min = 3;     ///< min number of beams on an object
  double hidden_max = 0.3;   ///< max fraction of it behind nearer objects
  bool in_picture = true;    ///< only objects entirely in the picture; false without a camera
  double gate_m = 0.3;       ///< max distance of a detected centre from the true axis
};

/// Numbers of correct, false and missed trees.
struct Counts {
  int num_right = 0;            ///< trees called TREE
  int num_wrong = 0;            ///< false detections of TREE
  int num_missed = 0;           ///< trees that count and are not called TREE
  int num_wrong_on_object = 0;  ///< part of num_wrong: on an object that is no tree
  int num_unseen = 0;           ///< part of num_missed: detected, but UNSEEN
  int num_not_detected = 0;     ///< part of num_missed: no detection

  double precision() const;  ///< 1 when nothing was called TREE
  double recall() const;     ///< 1 when no tree counts
  double f1() const;         ///< 2 right / (2 right + wrong + missed); 1 when all three are 0
};

/// Results for one interval of range, or one recording.
struct Slice {
  std::string name;
  double from_m = 0.0;
  double to_m = 0.0;
  Counts counts;
  ErrorStatistics centre;  ///< centre error of the trees called TREE
};

/// Classification by one confidence alone, at every threshold.
struct ScoreTest {
  std::string name;            ///< "colour only"
  double mean_of_trees = 0.0;  ///< mean score of the detected trees that count; section 6.2
  double mean_of_others = 0.0;
  double area = 0.5;            ///< under the ROC curve, over the detections
  double best_threshold = 0.0;  ///< max F1 on these same observations
  Counts best;
  std::vector<std::array<double, 2>> curve;  ///< recall, precision; threshold falling
};

/// Evaluation of landmarks of class tree against the true trees.
struct LandmarkEvaluation {
  Counts counts;
  Reliability reliability;  ///< of `probability`, for all landmarks except UNSEEN
  ErrorStatistics trees;
  int num_trees = 0;
};

struct DetectionEvaluation {
  DetectionRules rules;
  int num_scans = 0;
  int num_observations = 0;  ///< detections and true objects, paired or not
  Counts counts;             ///< for the published labels
  std::vector<Slice> by_range;
  std::vector<Slice> by_recording;
  std::vector<ScoreTest> tests;
  bool has_probability = false;
  Reliability reliability;  ///< of probability_tree, for all classified detections
  std::optional<LandmarkEvaluation> landmarks;
};

/// Computes precision, recall and F1 of class tree per observation, by range and by recording; the
/// paper's three tests and more; and the calibration of probability_tree. `names` are the
/// recordings' names.
DetectionEvaluation evaluate_detections(const std::vector<ObservationPair>& observations,
                                        const std::vector<std::string>& names,
                                        const DetectionRules& rules);

/// Counts the published labels.
Counts count_labels(const std::vector<ObservationPair>& observations, const DetectionRules& rules);

/// Centre errors of trees called TREE between two ranges [m].
ErrorStatistics centre_errors(const std::vector<ObservationPair>& observations,
                              const DetectionRules& rules, double from_m, double to_m);

/// Forecasts from the classified detections: probability_tree, and whether the object was a tree.
std::vector<Forecast> forecasts_of(const std::vector<ObservationPair>& observations);

/// Evaluates landmarks against the truth. With `was_observed` (by index in the truth), trees that
/// no observation counted are not counted as missed.
LandmarkEvaluation evaluate_landmarks(const std::vector<mapping::Landmark>& landmarks,
                                      const std::vector<simulation::TruthObject>& truth,
                                      const std::vector<bool>& was_observed, double gate_m,
                                      std::vector<Forecast>* forecasts = nullptr);

/// For each true object, whether any observation counted it.
std::vector<bool> was_observed(const std::vector<ObservationPair>& observations,
                               std::size_t num_objects, const DetectionRules& rules);

/// Adds counts.
Counts& operator+=(Counts& into, const Counts& more);

/// The results as one JSON object.
std::string detection_json(const DetectionEvaluation& evaluation);

/// True if an observation's true object counts under the rules: near, visible and with enough
/// beams.
bool counts(const ObservationPair& observation, const DetectionRules& rules);

/// True if counts() and the object is a tree.
bool counts_as_tree(const ObservationPair& observation, const DetectionRules& rules);

/// Adds one observation, classified as a tree or not, to the counts. TREE on a tree that does not
/// count is neither right nor wrong; TREE on any other object is wrong, however much it is hidden.
void count_observation(const ObservationPair& observation, bool is_called_tree,
                       const DetectionRules& rules, Counts& counts);

/// Evaluates each score alone: the paper's three tests (colour, edges, both; section 6.2), laser
/// only, all (roc_tree) and, where available, the calibrated probability.
///
/// A stage that was not reached because an earlier one failed has score 0, which no threshold
/// accepts as a tree: edges are searched only on objects with a trunk's colour.
std::vector<ScoreTest> score_tests(const std::vector<ObservationPair>& observations,
                                   const DetectionRules& rules);

}  // namespace orchard::evaluation
