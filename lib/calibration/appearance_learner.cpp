// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/appearance_learner.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>

#include "calibration/roc_area.hpp"
#include "vision/appearance.hpp"

namespace orchard::calibration {
namespace {

constexpr int kNumFeatures = static_cast<int>(vision::kNumAppearanceFeatures);
constexpr int kMinWindows = 10;  // of a class: fewer say nothing
constexpr int kMaxSteps = 50;
constexpr double kMinScale = 1e-6;

using Samples = std::vector<const AppearanceSample*>;

/// The weight of a sample, so that both classes count as half of all samples each.
struct ClassWeights {
  double trunk = 1.0, other = 1.0;

  explicit ClassWeights(const Samples& samples) {
    double num_trunk = 0.0;
    for (const AppearanceSample* sample : samples) num_trunk += sample->is_trunk ? 1.0 : 0.0;
    const auto n = static_cast<double>(samples.size());
    trunk = 0.5 * n / num_trunk;
    other = 0.5 * n / (n - num_trunk);
  }
  double of(const AppearanceSample& sample) const { return sample.is_trunk ? trunk : other; }
};

bool has_both_classes(const Samples& samples) {
  const auto is_trunk = [](const AppearanceSample* s) { return s->is_trunk; };
  return std::any_of(samples.begin(), samples.end(), is_trunk) &&
         !std::all_of(samples.begin(), samples.end(), is_trunk);
}

void standardise(const Samples& samples, vision::AppearanceConfig& config) {
  const auto n = static_cast<double>(samples.size());
  config.mean.assign(kNumFeatures, 0.0);
  config.scale.assign(kNumFeatures, 0.0);
  for (std::size_t i = 0; i < kNumFeatures; ++i) {
    for (const AppearanceSample* sample : samples) config.mean[i] += sample->features[i] / n;
    for (const AppearanceSample* sample : samples) {
      const double d = sample->features[i] - config.mean[i];
      config.scale[i] += d * d / n;
    }
    config.scale[i] = std::max(std::sqrt(config.scale[i]), kMinScale);
  }
}

Eigen::VectorXd standardised(const AppearanceSample& sample,
                             const vision::AppearanceConfig& config) {
  Eigen::VectorXd x(kNumFeatures + 1);
  x[kNumFeatures] = 1.0;
  for (int i = 0; i < kNumFeatures; ++i) {
    const auto k = static_cast<std::size_t>(i);
    x[i] = (sample.features[k] - config.mean[k]) / config.scale[k];
  }
  return x;
}

/// -log(1 / (1 + exp(-margin))) without overflow.
double loss_of(double margin) {
  return margin > 0.0 ? std::log1p(std::exp(-margin)) : -margin + std::log1p(std::exp(margin));
}

/// Penalised negative log likelihood of the coefficients.
double objective(const Samples& samples, const Eigen::MatrixXd& x, const ClassWeights& weights,
                 const Eigen::VectorXd& beta, double penalty) {
  double sum = 0.5 * penalty * beta.head(kNumFeatures).squaredNorm();
  const Eigen::VectorXd z = x.transpose() * beta;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double margin =
        samples[i]->is_trunk ? z[static_cast<Eigen::Index>(i)] : -z[static_cast<Eigen::Index>(i)];
    sum += weights.of(*samples[i]) * loss_of(margin);
  }
  return sum;
}

/// Newton's method with halved steps: the problem is convex, so it ends at the one minimum.
vision::AppearanceConfig fit(const Samples& samples, double penalty) {
  vision::AppearanceConfig config;
  standardise(samples, config);
  const ClassWeights weights(samples);
  Eigen::MatrixXd x(kNumFeatures + 1, static_cast<Eigen::Index>(samples.size()));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    x.col(static_cast<Eigen::Index>(i)) = standardised(*samples[i], config);
  }
  Eigen::VectorXd ridge = Eigen::VectorXd::Constant(kNumFeatures + 1, penalty);
  ridge[kNumFeatures] = 1e-9;  // the bias is free
  Eigen::VectorXd beta = Eigen::VectorXd::Zero(kNumFeatures + 1);
  double value = objective(samples, x, weights, beta, penalty);
  for (int step = 0; step < kMaxSteps; ++step) {
    Eigen::VectorXd gradient = ridge.cwiseProduct(beta);
    Eigen::VectorXd curvature(x.cols());
    const Eigen::VectorXd z = x.transpose() * beta;
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      const AppearanceSample& sample = *samples[static_cast<std::size_t>(i)];
      const double p = 1.0 / (1.0 + std::exp(-z[i]));
      const double w = weights.of(sample);
      gradient += w * (p - (sample.is_trunk ? 1.0 : 0.0)) * x.col(i);
      curvature[i] = w * p * (1.0 - p);
    }
    Eigen::MatrixXd hessian = x * curvature.asDiagonal() * x.transpose();
    hessian.diagonal() += ridge;
    const Eigen::VectorXd newton = hessian.ldlt().solve(gradient);
    double length = 1.0, next = 0.0;
    for (; length > 1e-6; length *= 0.5) {
      next = objective(samples, x, weights, beta - length * newton, penalty);
      if (next <= value) break;
    }
    if (next > value) break;
    beta -= length * newton;
    const double gain = value - next;
    value = next;
    if (gain <= 1e-10 * std::abs(value)) break;
  }
  config.weights.assign(beta.data(), beta.data() + kNumFeatures);
  config.bias = beta[kNumFeatures];
  return config;
}

/// What a penalty scores on groups that were left out.
struct CrossValidation {
  double log_loss = 0.0;
  double area = 0.5;
};

CrossValidation cross_validate(const std::vector<AppearanceSample>& samples,
                               const std::map<int, int>& fold_of_group, int num_folds,
                               double penalty) {
  std::vector<double> trunk, other;
  double trunk_loss = 0.0, other_loss = 0.0;
  for (int fold = 0; fold < num_folds; ++fold) {
    Samples kept, left_out;
    for (const AppearanceSample& sample : samples) {
      (fold_of_group.at(sample.group) == fold ? left_out : kept).push_back(&sample);
    }
    if (!has_both_classes(kept)) continue;
    const vision::AppearanceConfig config = fit(kept, penalty);
    for (const AppearanceSample* sample : left_out) {
      const double log_odds = vision::appearance_log_odds(sample->features, config);
      (sample->is_trunk ? trunk : other).push_back(log_odds);
      (sample->is_trunk ? trunk_loss : other_loss) +=
          loss_of(sample->is_trunk ? log_odds : -log_odds);
    }
  }
  CrossValidation result;
  result.area = roc_area(trunk, other);
  result.log_loss = 0.5 * (trunk_loss / std::max<double>(1.0, static_cast<double>(trunk.size())) +
                           other_loss / std::max<double>(1.0, static_cast<double>(other.size())));
  return result;
}

void check(const std::vector<AppearanceSample>& samples, const AppearanceFit& found) {
  if (found.num_trunk < kMinWindows || found.num_other < kMinWindows) {
    throw std::runtime_error("there are " + std::to_string(found.num_trunk) +
                             " windows on trunks and " + std::to_string(found.num_other) +
                             " elsewhere; at least " + std::to_string(kMinWindows) +
                             " of each are needed to learn what trunks look like");
  }
  for (const AppearanceSample& sample : samples) {
    for (const double value : sample.features) {
      if (!std::isfinite(value)) throw std::runtime_error("a window has a feature of no value");
    }
  }
}

}  // namespace

AppearanceFit learn_appearance(const std::vector<AppearanceSample>& samples,
                               const AppearanceLearnOptions& options) {
  AppearanceFit found;
  std::map<int, int> fold_of_group;
  for (const AppearanceSample& sample : samples) {
    ++(sample.is_trunk ? found.num_trunk : found.num_other);
    fold_of_group[sample.group] = 0;
  }
  check(samples, found);
  found.num_groups = static_cast<int>(fold_of_group.size());
  const int num_folds = std::min(found.num_groups, options.max_folds);
  int next = 0;
  for (auto& [group, fold] : fold_of_group) fold = next++ % num_folds;

  found.penalty = options.penalties.front();
  if (num_folds > 1) {
    found.log_loss = std::numeric_limits<double>::infinity();
    for (const double penalty : options.penalties) {
      const CrossValidation score = cross_validate(samples, fold_of_group, num_folds, penalty);
      if (score.log_loss >= found.log_loss) continue;
      found.penalty = penalty;
      found.log_loss = score.log_loss;
      found.area = score.area;
    }
  }
  Samples all;
  for (const AppearanceSample& sample : samples) all.push_back(&sample);
  found.config = fit(all, found.penalty);
  return found;
}

}  // namespace orchard::calibration
