// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace orchard::calibration {

/// Observations of a multinomial logistic regression with three outcomes.
struct MultinomialData {
  Eigen::MatrixXd features;   ///< one column per observation
  std::vector<int> outcomes;  ///< 0, 1, or 2: the reference, whose weights are 0
  std::vector<int> clusters;  ///< observations of one cluster are not independent
};

/// Weights of outcomes 0 and 1 (columns) per feature (rows), and their standard errors.
struct MultinomialFit {
  Eigen::MatrixXd weights;
  Eigen::MatrixXd standard_errors;  ///< sandwich estimator over clusters
};

/// Maximum likelihood with a ridge on all weights: Newton's method with halved steps on a convex
/// problem, so it ends at the one minimum. Without observations all weights are 0.
MultinomialFit fit_multinomial(const MultinomialData& data, double penalty,
                               bool with_standard_errors = true);

}  // namespace orchard::calibration
