// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "vision/appearance/appearance_config.hpp"

namespace orchard::calibration {

/// One window whose truth is known.
struct AppearanceSample {
  vision::AppearanceFeatures features{};
  bool is_trunk = false;
  /// What it was taken from: a picture, or a trunk. Windows of one group resemble each other, so
  /// cross-validation never fits on one to check on another.
  int group = 0;
};

/// How the model is learnt.
struct AppearanceLearnOptions {
  /// Ridge penalties to choose from, rising, in units of the log likelihood of one window.
  std::vector<double> penalties{1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0};
  int max_folds = 10;
};

/// A learnt model and how well it did on groups that were left out of the fit.
struct AppearanceFit {
  vision::AppearanceConfig config;  ///< confidence_min is left at its default
  double penalty = 0.0;
  double area = 0.5;      ///< area under the ROC curve, of windows left out; 0.5 if none could be
  double log_loss = 0.0;  ///< mean over windows left out, both classes alike [nat]; 0 likewise
  int num_trunk = 0;      ///< windows
  int num_other = 0;
  int num_groups = 0;
};

/// Learns what trunks look like: a logistic regression on standardised features, with their squares
/// where fits to a part of the groups then rank all others better, both classes weighing the same.
/// The ridge penalty is the strongest with which fits to a part of the groups rank all others best
/// (the middle one of those given where the groups cannot be parted); then the log odds are scaled
/// to be true of groups left out.
///
/// The same samples in the same order give the same bits. Throws std::runtime_error with one
/// sentence when there are fewer than ten windows of a class or a feature is not finite.
AppearanceFit learn_appearance(const std::vector<AppearanceSample>& samples,
                               const AppearanceLearnOptions& options = {});

}  // namespace orchard::calibration
