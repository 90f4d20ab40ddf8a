// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "detection/detection.hpp"
#include "detection/probability.hpp"

namespace orchard::calibration {

/// True class of a detection.
enum class Outcome { kTree, kObject, kNeither };

/// One detection with ground truth.
struct ProbabilitySample {
  detection::Detection detection;
  Outcome outcome = Outcome::kNeither;
  int recording = 0;
  int object = -1;  ///< index of the observed object in the recording's truth; -1 = none
};

/// One list of weights with standard errors.
struct FittedWeights {
  std::vector<double> values;
  /// Standard errors that account for the correlation of observations of one object (sandwich
  /// estimator, one cluster per object and recording).
  std::vector<double> standard_errors;
};

/// What cross-validation leaves out of the fit.
enum class LeftOut {
  kRecordings,  ///< whole recordings
  kObjects,     ///< whole objects of a single recording, and stretches of its false alarms
  kNothing,     ///< too few trees to leave one out: the figures are of the training data
};

/// A learnt model and its cross-validation results.
struct ProbabilityFit {
  detection::ProbabilityConfig config;  ///< enabled
  FittedWeights judged_tree, judged_object, laser_tree, laser_object;
  int num_judged = 0;  ///< number of training observations
  int num_laser = 0;
  int num_recordings = 0;
  double base_rate = 0.5;    ///< fraction of trees in the observations: mapper.evidence_base_rate
  double prior = 0.5;        ///< mapper.evidence_prior
  double correlation = 0.0;  ///< mapper.evidence_correlation
  int num_objects = 0;       ///< number of objects for prior and correlation
  LeftOut left_out = LeftOut::kNothing;
  double log_loss = 0.0;  ///< mean over left-out observations [nat]
  /// probability_tree of each sample by weights fitted without it; -1 = hidden.
  std::vector<double> left_out_tree;
};

/// Options of the fit.
struct ProbabilityLearnOptions {
  double width_mean_m = 0.1;  ///< detector.width.mean_m of the rig that recorded the detections
  double penalty = 1.0;       ///< ridge, in units of the log likelihood of one observation
  int max_folds = 10;
};

/// Fits the multinomial logistic regression of detection::tree_probability() by Newton's method,
/// then the mapper's prior and the correlation of the observations of one object from the log loss
/// over objects. Deterministic for the same samples in the same order.
///
/// Cross-validation leaves out whole recordings; of a single recording whole objects, because the
/// observations of one object are alike, and what belongs to no object by stretches of time (the
/// samples of a recording are in order of time).
///
/// Throws std::runtime_error with one sentence for fewer than 20 observations of trees or fewer
/// than 20 of anything else.
ProbabilityFit learn_probability(const std::vector<ProbabilitySample>& samples,
                                 const ProbabilityLearnOptions& options);

/// Wrong decisions on the same labelled detections.
struct DecisionErrors {
  int num = 0;          ///< detections that are labelled
  int roc = 0;          ///< wrong with decision: roc
  int probability = 0;  ///< wrong with decision: probability, by weights fitted without them
};

/// Compares both decisions of the detector. `samples` are detections of a detector with decision:
/// roc, `fit` what learn_probability() made of them. What is UNSEEN is so with either.
DecisionErrors decision_errors(const std::vector<ProbabilitySample>& samples,
                               const ProbabilityFit& fit);

}  // namespace orchard::calibration
