// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/multinomial.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <map>

namespace orchard::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// derived: budget; Newton's method doubles the digits with each step.
constexpr int kNewtonSteps = 60;

/// The penalised negative log likelihood of weights `beta`, features x outcomes.
class Likelihood {
 public:
  Likelihood(const MultinomialData& data, const Eigen::VectorXd& ridge)
      : x_(data.features),
        ridge_(ridge),
        shares_(Eigen::RowVectorXd::Ones(x_.cols())),
        happened_(MatrixXd::Zero(data.num_outcomes - 1, x_.cols())) {
    for (Index i = 0; i < x_.cols(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (!data.shares.empty()) shares_[i] = data.shares[k];
      if (data.outcomes[k] < happened_.rows()) happened_(data.outcomes[k], i) = 1.0;
    }
  }

  double at(const MatrixXd& beta) const {
    const MatrixXd z = beta.transpose() * x_;
    const Eigen::RowVectorXd losses = log_sums(z) - happened_.cwiseProduct(z).colwise().sum();
    return 0.5 * ridge_.dot(beta.cwiseAbs2().rowwise().sum()) + losses.dot(shares_);
  }

  MatrixXd gradient(const MatrixXd& beta) const {
    return ridge_.asDiagonal() * beta -
           x_ * shares_.asDiagonal() * (happened_ - probabilities(beta)).transpose();
  }

  /// In the order of the columns of beta.
  MatrixXd hessian(const MatrixXd& beta) const {
    const MatrixXd p = probabilities(beta);
    const Index k = x_.rows(), num = p.rows();
    MatrixXd hessian = ridge_.replicate(num, 1).asDiagonal();
    for (Index a = 0; a < num; ++a) {
      for (Index b = 0; b < num; ++b) {
        Eigen::RowVectorXd spread = -p.row(a).cwiseProduct(p.row(b));
        if (a == b) spread += p.row(a);
        hessian.block(a * k, b * k, k, k) +=
            x_ * spread.cwiseProduct(shares_).asDiagonal() * x_.transpose();
      }
    }
    return hessian;
  }

  /// Standard errors with correlated observations: inverse(hessian) (scores of the clusters)
  /// inverse(hessian).
  MatrixXd sandwich(const MatrixXd& beta, const std::vector<int>& clusters) const {
    const MatrixXd off = (happened_ - probabilities(beta)) * shares_.asDiagonal();
    std::map<int, MatrixXd> scores;
    for (Index i = 0; i < off.cols(); ++i) {
      const auto at = scores.try_emplace(clusters[static_cast<std::size_t>(i)],
                                         MatrixXd::Zero(beta.rows(), beta.cols()));
      at.first->second += x_.col(i) * off.col(i).transpose();
    }
    MatrixXd meat = MatrixXd::Zero(beta.size(), beta.size());
    for (const auto& [cluster, score] : scores) {
      meat += score.reshaped() * score.reshaped().transpose();
    }
    const MatrixXd bread = hessian(beta).ldlt().solve(MatrixXd::Identity(beta.size(), beta.size()));
    const Eigen::VectorXd variances = (bread * meat * bread).diagonal().cwiseMax(0.0);
    return variances.cwiseSqrt().reshaped(beta.rows(), beta.cols());
  }

 private:
  static Eigen::RowVectorXd log_sums(const MatrixXd& z) {
    const Eigen::RowVectorXd most = z.colwise().maxCoeff().cwiseMax(0.0);
    const Eigen::RowVectorXd others = (z.rowwise() - most).array().exp().matrix().colwise().sum();
    return most.array() + (others.array() + (-most.array()).exp()).log();
  }
  MatrixXd probabilities(const MatrixXd& beta) const {
    const MatrixXd z = beta.transpose() * x_;
    return (z.rowwise() - log_sums(z)).array().exp();
  }

  const MatrixXd& x_;
  const Eigen::VectorXd& ridge_;
  Eigen::RowVectorXd shares_;
  MatrixXd happened_;
};

}  // namespace

MultinomialFit fit_multinomial(const MultinomialData& data, const Eigen::VectorXd& ridge) {
  const Likelihood likelihood(data, ridge);
  MatrixXd beta = MatrixXd::Zero(data.features.rows(), data.num_outcomes - 1);
  double value = likelihood.at(beta);
  for (int step = 0; step < kNewtonSteps; ++step) {
    const Eigen::VectorXd newton =
        likelihood.hessian(beta).ldlt().solve(likelihood.gradient(beta).reshaped());
    const MatrixXd way = newton.reshaped(beta.rows(), beta.cols());
    double length = 1.0, next = value;
    for (; length > 1e-8; length *= 0.5) {
      next = likelihood.at(beta - length * way);
      if (next <= value) break;
    }
    if (!(next <= value)) break;
    beta -= length * way;
    const double gain = value - next;
    value = next;
    if (gain <= 1e-10 * std::abs(value)) break;
  }
  const bool has_clusters = !data.clusters.empty();
  return {beta, has_clusters ? likelihood.sandwich(beta, data.clusters) : MatrixXd()};
}

}  // namespace orchard::calibration
