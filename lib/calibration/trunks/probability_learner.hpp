// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "detection/detection.hpp"
#include "detection/probability.hpp"

namespace orchard::calibration {

/// What a detection turned out to be.
enum class Outcome { kTree, kObject, kNeither };

/// One detection whose truth is known.
struct ProbabilitySample {
  detection::Detection detection;
  Outcome outcome = Outcome::kNeither;
  int recording = 0;  ///< observations of one recording are left out together in cross-validation
  int thing = -1;  ///< what it was an observation of: place in the recording's truth; -1 = nothing
};

/// One list of weights with how sure they are.
struct FittedWeights {
  std::vector<double> values;
  /// Standard errors that allow for observations of one thing resembling each other (sandwich
  /// estimator, one cluster per thing and recording).
  std::vector<double> standard_errors;
};

/// A learnt model and how well it did on recordings that were left out of the fit.
struct ProbabilityFit {
  detection::ProbabilityConfig config;  ///< enabled
  FittedWeights judged_tree, judged_object, laser_tree, laser_object;
  int num_judged = 0;  ///< observations learnt from
  int num_laser = 0;
  int num_recordings = 0;
  double base_rate = 0.5;    ///< trees' fraction of the observations: mapper.evidence_base_rate
  double prior = 0.5;        ///< mapper.evidence_prior
  double correlation = 0.0;  ///< mapper.evidence_correlation
  int num_things = 0;        ///< that prior and correlation are from
  double log_loss =
      0.0;  ///< mean over observations left out [nat]; of the fit itself with one recording
  std::vector<double> left_out_tree;  ///< probability_tree of each sample in its order, by
                                      ///< weights that never saw its recording; -1 = hidden
};

/// How the weights are fitted.
struct ProbabilityLearnOptions {
  double width_mean_m = 0.1;  ///< detector.width.mean_m of the rig that made the detections
  double penalty = 1.0;       ///< ridge, in units of the log likelihood of one observation
  int max_folds = 10;
};

/// Fits the multinomial logistic regression of detection::tree_probability() by Newton's method,
/// then the mapper's prior and the correlation of observations of one thing by maximum likelihood
/// over things. The same samples in the same order give the same bits.
///
/// Throws std::runtime_error with one sentence when there are fewer than 20 observations of trees
/// or at anything else.
ProbabilityFit learn_probability(const std::vector<ProbabilitySample>& samples,
                                 const ProbabilityLearnOptions& options);

}  // namespace orchard::calibration
