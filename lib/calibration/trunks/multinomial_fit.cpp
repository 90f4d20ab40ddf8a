// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/multinomial_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

namespace orchard::calibration {
namespace {

constexpr int kNewtonSteps = 60;

/// Probabilities of outcomes 0 and 1; returns the log of the sum of exponentials.
double probabilities(double a, double b, double& p_a, double& p_b) {
  const double most = std::max({0.0, a, b});
  const double sum = std::exp(a - most) + std::exp(b - most) + std::exp(-most);
  p_a = std::exp(a - most) / sum;
  p_b = std::exp(b - most) / sum;
  return most + std::log(sum);
}

/// Penalised negative log likelihood of the stacked weights.
double objective(const MultinomialData& data, const Eigen::VectorXd& beta, double penalty) {
  const Eigen::Index k = data.features.rows();
  const Eigen::VectorXd a = data.features.transpose() * beta.head(k);
  const Eigen::VectorXd b = data.features.transpose() * beta.tail(k);
  double sum = 0.5 * penalty * beta.squaredNorm(), p_a = 0.0, p_b = 0.0;
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    const int outcome = data.outcomes[static_cast<std::size_t>(i)];
    sum += probabilities(a[i], b[i], p_a, p_b) - (outcome == 0 ? a[i] : outcome == 1 ? b[i] : 0.0);
  }
  return sum;
}

/// Residuals (outcome minus probability, per outcome) and the Hessian of the objective.
struct Slope {
  Eigen::VectorXd residual_a, residual_b;
  Eigen::MatrixXd hessian;
};

Slope slope_at(const MultinomialData& data, const Eigen::VectorXd& beta, double penalty) {
  const Eigen::Index k = data.features.rows(), n = data.features.cols();
  const Eigen::VectorXd a = data.features.transpose() * beta.head(k);
  const Eigen::VectorXd b = data.features.transpose() * beta.tail(k);
  Slope slope;
  slope.residual_a.resize(n);
  slope.residual_b.resize(n);
  Eigen::VectorXd aa(n), ab(n), bb(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    double p_a = 0.0, p_b = 0.0;
    probabilities(a[i], b[i], p_a, p_b);
    const int outcome = data.outcomes[static_cast<std::size_t>(i)];
    slope.residual_a[i] = (outcome == 0 ? 1.0 : 0.0) - p_a;
    slope.residual_b[i] = (outcome == 1 ? 1.0 : 0.0) - p_b;
    aa[i] = p_a * (1.0 - p_a);
    bb[i] = p_b * (1.0 - p_b);
    ab[i] = -p_a * p_b;
  }
  const Eigen::MatrixXd& x = data.features;
  slope.hessian.resize(2 * k, 2 * k);
  slope.hessian.topLeftCorner(k, k) = x * aa.asDiagonal() * x.transpose();
  slope.hessian.topRightCorner(k, k) = x * ab.asDiagonal() * x.transpose();
  slope.hessian.bottomLeftCorner(k, k) = slope.hessian.topRightCorner(k, k).transpose();
  slope.hessian.bottomRightCorner(k, k) = x * bb.asDiagonal() * x.transpose();
  slope.hessian.diagonal().array() += penalty;
  return slope;
}

Eigen::MatrixXd unstacked(const Eigen::VectorXd& beta) {
  return Eigen::Map<const Eigen::MatrixXd>(beta.data(), beta.size() / 2, 2);
}

Eigen::VectorXd sandwich(const MultinomialData& data, const Slope& slope) {
  const Eigen::Index k = data.features.rows();
  std::map<int, Eigen::VectorXd> scores;
  for (Eigen::Index i = 0; i < data.features.cols(); ++i) {
    auto [at, is_new] = scores.try_emplace(data.clusters[static_cast<std::size_t>(i)],
                                           Eigen::VectorXd::Zero(2 * k));
    at->second.head(k) += slope.residual_a[i] * data.features.col(i);
    at->second.tail(k) += slope.residual_b[i] * data.features.col(i);
  }
  Eigen::MatrixXd meat = Eigen::MatrixXd::Zero(2 * k, 2 * k);
  for (const auto& [cluster, score] : scores) meat += score * score.transpose();
  const Eigen::MatrixXd bread = slope.hessian.ldlt().solve(Eigen::MatrixXd::Identity(2 * k, 2 * k));
  return (bread * meat * bread).diagonal().cwiseMax(0.0).cwiseSqrt();
}

}  // namespace

MultinomialFit fit_multinomial(const MultinomialData& data, double penalty,
                               bool with_standard_errors) {
  const Eigen::Index k = data.features.rows();
  Eigen::VectorXd beta = Eigen::VectorXd::Zero(2 * k);
  double value = objective(data, beta, penalty);
  for (int step = 0; step < kNewtonSteps; ++step) {
    const Slope slope = slope_at(data, beta, penalty);
    Eigen::VectorXd gradient = penalty * beta;
    gradient.head(k) -= data.features * slope.residual_a;
    gradient.tail(k) -= data.features * slope.residual_b;
    const Eigen::VectorXd newton = slope.hessian.ldlt().solve(gradient);
    double length = 1.0, next = value;
    for (; length > 1e-8; length *= 0.5) {
      next = objective(data, beta - length * newton, penalty);
      if (next <= value) break;
    }
    if (!(next <= value)) break;
    beta -= length * newton;
    const double gain = value - next;
    value = next;
    if (gain <= 1e-9 * (1.0 + std::abs(value))) break;
  }
  MultinomialFit fit;
  fit.weights = unstacked(beta);
  fit.standard_errors = Eigen::MatrixXd::Zero(k, 2);
  if (with_standard_errors) {
    fit.standard_errors = unstacked(sandwich(data, slope_at(data, beta, penalty)));
  }
  return fit;
}

}  // namespace orchard::calibration
