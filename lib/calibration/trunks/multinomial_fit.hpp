// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace orchard::calibration {

/// Observations for a multinomial logistic regression with three outcomes.
struct MultinomialData {
  Eigen::MatrixXd features;   ///< one column per observation
  std::vector<int> outcomes;  ///< 0, 1 or 2; 2 is the reference with weights 0
  std::vector<int> clusters;  ///< cluster of each; observations in a cluster are correlated
};

/// Weights of outcomes 0 and 1 (columns) per feature (rows), and their standard errors.
struct MultinomialFit {
  Eigen::MatrixXd weights;
  Eigen::MatrixXd standard_errors;  ///< sandwich estimator over clusters
};

/// Fits the weights by maximum likelihood with a ridge penalty on all of them: Newton's method with
/// step halving; the problem is convex, so it converges to the global minimum. Without observations
/// all weights are 0.
MultinomialFit fit_multinomial(const MultinomialData& data, double penalty,
                               bool with_standard_errors = true);

}  // namespace orchard::calibration
