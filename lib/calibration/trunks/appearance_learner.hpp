// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "vision/appearance_config.hpp"

namespace orchard::calibration {

/// One window with ground truth.
struct AppearanceSample {
  vision::AppearanceFeatures features{};
  bool is_trunk = false;
  /// The image or trunk that it was taken from. Windows of one group are similar, so
  /// cross-validation keeps a group in one fold.
  int group = 0;
};

/// Options for learning the model.
struct AppearanceLearnOptions {
  /// Ridge penalties to choose from, ascending, in units of the log likelihood of one window.
  std::vector<double> penalties{1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0};
  int max_folds = 10;
};

/// A learnt model and its cross-validation results.
struct AppearanceFit {
  vision::AppearanceConfig config;  ///< confidence_min has its default
  double penalty = 0.0;
  double area = 0.5;  ///< area under the ROC curve of left-out windows; 0.5 without folds
  /// Mean over left-out windows with equal class weights [nat]; 0 without folds.
  double log_loss = 0.0;
  int num_trunk = 0;  ///< number of windows on trunks
  int num_other = 0;
  int num_groups = 0;
  /// Log odds of each sample by a model learnt without its group; NaN if its fold has one class
  /// only.
  std::vector<double> left_out;
};

/// Learns the appearance model of trunks: a logistic regression on standardised features with equal
/// class weights. Squares of the features are included if left-out folds are then ranked better,
/// and the ridge penalty is the strongest within one standard error of the best (the middle one of
/// those given if there are no folds). Finally the log odds are calibrated on left-out groups.
///
/// Deterministic for the same samples in the same order. Throws std::runtime_error with one
/// sentence for fewer than ten windows of a class or a feature that is not finite.
AppearanceFit learn_appearance(const std::vector<AppearanceSample>& samples,
                               const AppearanceLearnOptions& options = {});

}  // namespace orchard::calibration
