// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace orchard::calibration {

/// Observations for a logistic regression with two or more outcomes.
struct MultinomialData {
  Eigen::MatrixXd features;   ///< one column per observation
  std::vector<int> outcomes;  ///< 0 to num_outcomes - 1; the last is the reference with weights 0
  std::vector<int> clusters;  ///< observations of one are correlated; empty: no standard errors
  std::vector<double> shares = {};  ///< how much each observation counts; empty: 1
  int num_outcomes = 3;
};

/// Weights of every outcome but the reference (columns) per feature (rows).
struct MultinomialFit {
  Eigen::MatrixXd weights;
  Eigen::MatrixXd standard_errors;  ///< sandwich estimator over clusters
};

/// Fits the weights by maximum likelihood with a ridge penalty per feature: Newton's method with
/// step halving; the problem is convex, so it converges to the global minimum. Without observations
/// all weights are 0.
MultinomialFit fit_multinomial(const MultinomialData& data, const Eigen::VectorXd& ridge);

}  // namespace orchard::calibration
