// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/appearance_learner.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
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
  double penalty = 0.0;
  double log_loss = 0.0;  ///< mean over the folds
  double area = 0.5;
  std::vector<double> fold_losses;
};

double balanced_loss(const Samples& samples, const vision::AppearanceConfig& config) {
  const ClassWeights weights(samples);
  double sum = 0.0;
  for (const AppearanceSample* sample : samples) {
    const double log_odds = vision::appearance_log_odds(sample->features, config);
    sum += weights.of(*sample) * loss_of(sample->is_trunk ? log_odds : -log_odds);
  }
  return sum / static_cast<double>(samples.size());
}

CrossValidation cross_validate(const std::vector<AppearanceSample>& samples,
                               const std::map<int, int>& fold_of_group, int num_folds,
                               double penalty) {
  CrossValidation result;
  result.penalty = penalty;
  std::vector<double> trunk, other;
  for (int fold = 0; fold < num_folds; ++fold) {
    Samples kept, left_out;
    for (const AppearanceSample& sample : samples) {
      (fold_of_group.at(sample.group) == fold ? left_out : kept).push_back(&sample);
    }
    if (!has_both_classes(kept) || !has_both_classes(left_out)) continue;
    const vision::AppearanceConfig config = fit(kept, penalty);
    for (const AppearanceSample* sample : left_out) {
      (sample->is_trunk ? trunk : other)
          .push_back(vision::appearance_log_odds(sample->features, config));
    }
    result.fold_losses.push_back(balanced_loss(left_out, config));
  }
  result.area = roc_area(trunk, other);
  for (const double loss : result.fold_losses) {
    result.log_loss += loss / static_cast<double>(result.fold_losses.size());
  }
  return result;
}

/// Whether a score is worse than the best by no more than the standard error of the difference,
/// fold by fold: then nothing shows that it is worse.
bool as_good_as(const CrossValidation& score, const CrossValidation& best) {
  const auto n = static_cast<double>(best.fold_losses.size());
  const double mean = score.log_loss - best.log_loss;
  double squares = 0.0;
  for (std::size_t i = 0; i < best.fold_losses.size(); ++i) {
    const double d = score.fold_losses[i] - best.fold_losses[i] - mean;
    squares += d * d;
  }
  return n > 1.0 && mean <= std::sqrt(squares / (n * (n - 1.0)));
}

/// The strongest penalty that is as good as the best one: smaller weights meet new light better.
CrossValidation choose_penalty(const std::vector<AppearanceSample>& samples,
                               const std::map<int, int>& fold_of_group, int num_folds,
                               const std::vector<double>& penalties) {
  std::vector<CrossValidation> scores;
  for (const double penalty : penalties) {
    scores.push_back(cross_validate(samples, fold_of_group, num_folds, penalty));
  }
  const auto less = [](const auto& a, const auto& b) { return a.log_loss < b.log_loss; };
  const CrossValidation best = *std::min_element(scores.begin(), scores.end(), less);
  CrossValidation chosen = best;
  for (const CrossValidation& score : scores) {
    if (score.penalty > chosen.penalty && as_good_as(score, best)) chosen = score;
  }
  return chosen;
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

  found.penalty = options.penalties.at(options.penalties.size() / 2);
  if (num_folds > 1) {
    const CrossValidation chosen =
        choose_penalty(samples, fold_of_group, num_folds, options.penalties);
    found.penalty = chosen.penalty;
    found.log_loss = chosen.log_loss;
    found.area = chosen.area;
  }
  Samples all;
  for (const AppearanceSample& sample : samples) all.push_back(&sample);
  found.config = fit(all, found.penalty);
  return found;
}

}  // namespace orchard::calibration
