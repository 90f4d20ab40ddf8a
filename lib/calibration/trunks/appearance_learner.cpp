// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/appearance_learner.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "calibration/trunks/multinomial.hpp"
#include "geometry/statistics.hpp"
#include "vision/appearance.hpp"

namespace orchard::calibration {
namespace {

// derived: limits of the fit, never reached by data that can be learnt from.
constexpr int kNumFeatures = static_cast<int>(vision::kNumAppearanceFeatures);
constexpr int kMinWindows = 10;  // per class
constexpr double kMinScale = 1e-6;
constexpr double kNoRidge = 1e-9;  // keeps the equations solvable

using Samples = std::vector<const AppearanceSample*>;

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

/// Model selection: the ridge penalty, and whether the features' squares are included.
struct Shape {
  double penalty = 0.0;
  bool squares = false;

  int num_terms() const { return squares ? 2 * kNumFeatures : kNumFeatures; }
};

/// The terms of appearance_log_odds() and a final 1 for the bias.
Eigen::VectorXd terms_of(const AppearanceSample& sample, const vision::AppearanceConfig& config,
                         const Shape& shape) {
  Eigen::VectorXd x(shape.num_terms() + 1);
  x[shape.num_terms()] = 1.0;
  for (int i = 0; i < kNumFeatures; ++i) {
    const auto k = static_cast<std::size_t>(i);
    x[i] = (sample.features[k] - config.mean[k]) / config.scale[k];
    if (!shape.squares) continue;
    const double cut =
        std::clamp(x[i], -vision::kAppearanceSquareReach, vision::kAppearanceSquareReach);
    x[kNumFeatures + i] = cut * cut - 1.0;
  }
  return x;
}

/// -log(1 / (1 + exp(-margin))) without overflow.
double loss_of(double margin) {
  return margin > 0.0 ? std::log1p(std::exp(-margin)) : -margin + std::log1p(std::exp(margin));
}

/// One observation per trunk or other window, each class with half of the total weight `total`.
MultinomialData data_of(Eigen::MatrixXd features, const std::vector<char>& is_trunk, double total) {
  const auto num_trunk = static_cast<double>(std::count(is_trunk.begin(), is_trunk.end(), 1));
  const double num_other = static_cast<double>(is_trunk.size()) - num_trunk;
  MultinomialData data{std::move(features), {}, {}, {}, 2};
  for (const char trunk : is_trunk) {
    data.outcomes.push_back(trunk ? 0 : 1);
    data.shares.push_back(0.5 * total / (trunk ? num_trunk : num_other));
  }
  return data;
}

vision::AppearanceConfig fit(const Samples& samples, const Shape& shape) {
  vision::AppearanceConfig config;
  standardise(samples, config);
  const int num_terms = shape.num_terms();
  Eigen::MatrixXd x(num_terms + 1, static_cast<Eigen::Index>(samples.size()));
  std::vector<char> is_trunk;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    x.col(static_cast<Eigen::Index>(i)) = terms_of(*samples[i], config, shape);
    is_trunk.push_back(samples[i]->is_trunk);
  }
  Eigen::VectorXd ridge = Eigen::VectorXd::Constant(num_terms + 1, shape.penalty);
  ridge[num_terms] = kNoRidge;  // the bias has no penalty
  const auto data = data_of(std::move(x), is_trunk, static_cast<double>(samples.size()));
  const Eigen::VectorXd beta = fit_multinomial(data, ridge).weights;
  config.weights.assign(beta.data(), beta.data() + kNumFeatures);
  if (shape.squares) config.squares.assign(beta.data() + kNumFeatures, beta.data() + num_terms);
  config.bias = beta[num_terms];
  return config;
}

/// The samples of one fold, and those of all other folds.
struct Fold {
  Samples inside, outside;
};

/// Assigns whole groups to folds in turn, groups with and without trunks separately. Returns only
/// folds that have both classes inside and outside.
std::vector<Fold> deal_folds(const std::vector<AppearanceSample>& samples, int max_folds) {
  std::map<int, bool> has_trunk;
  for (const AppearanceSample& sample : samples) has_trunk[sample.group] |= sample.is_trunk;
  const int num_folds = std::min(static_cast<int>(has_trunk.size()), max_folds);
  std::map<int, int> fold_of;
  int next_with = 0, next_without = 0;
  for (const auto& [group, with] : has_trunk) {
    fold_of[group] = (with ? next_with++ : next_without++) % num_folds;
  }
  std::vector<Fold> folds(static_cast<std::size_t>(num_folds));
  for (const AppearanceSample& sample : samples) {
    for (std::size_t i = 0; i < folds.size(); ++i) {
      const bool is_inside = fold_of.at(sample.group) == static_cast<int>(i);
      (is_inside ? folds[i].inside : folds[i].outside).push_back(&sample);
    }
  }
  const auto useless = [](const Fold& fold) {
    return !has_both_classes(fold.inside) || !has_both_classes(fold.outside);
  };
  folds.erase(std::remove_if(folds.begin(), folds.end(), useless), folds.end());
  return folds;
}

/// Log odds of windows, separated by their true class.
struct Judged {
  std::vector<double> trunk, other;

  void add(const Samples& samples, const vision::AppearanceConfig& config) {
    for (const AppearanceSample* sample : samples) {
      (sample->is_trunk ? trunk : other)
          .push_back(vision::appearance_log_odds(sample->features, config));
    }
  }
};

/// Areas under the ROC curve of left-out folds: their mean and its standard error.
struct AreaOfFolds {
  double mean = 0.0;
  double se = 0.0;
};

AreaOfFolds area_of_left_out(const std::vector<Fold>& folds, const Shape& shape) {
  const auto n = static_cast<double>(folds.size());
  double sum = 0.0, squares = 0.0;
  for (const Fold& fold : folds) {
    Judged judged;
    judged.add(fold.inside, fit(fold.outside, shape));
    const double area = geometry::roc_area(judged.trunk, judged.other);
    sum += area;
    squares += area * area;
  }
  const double mean = sum / n;
  const double variance = n > 1.0 ? (squares - n * mean * mean) / (n - 1.0) : 0.0;
  return {mean, std::sqrt(std::max(variance, 0.0) / n)};
}

/// Selects the best model on left-out folds, and of its kind the strongest penalty that is within
/// one standard error of it: an orchard has more trees and more kinds of light than the training
/// data. Source: Breiman et al. 1984, the one standard error rule.
Shape choose_shape(const std::vector<Fold>& folds, const AppearanceLearnOptions& options) {
  if (folds.empty()) return {options.penalties.at(options.penalties.size() / 2), false};
  AreaOfFolds best_area;
  Shape best;
  std::vector<AreaOfFolds> areas_of_best;
  for (const bool squares : {false, true}) {
    std::vector<AreaOfFolds> areas;
    bool better = false;
    for (const double penalty : options.penalties) {
      areas.push_back(area_of_left_out(folds, {penalty, squares}));
      if (areas.back().mean <= best_area.mean) continue;
      best_area = areas.back();
      best = {penalty, squares};
      better = true;
    }
    if (better) areas_of_best = areas;
  }
  for (std::size_t i = 0; i < areas_of_best.size(); ++i) {
    if (areas_of_best[i].mean < best_area.mean - best_area.se) continue;
    best.penalty = std::max(best.penalty, options.penalties[i]);
  }
  return best;
}

/// Calibration of log odds x: offset + slope x.
struct Calibration {
  double offset = 0.0;
  double slope = 1.0;
};

/// Platt scaling: logistic regression of the true class on the log odds of left-out windows, with
/// equal class weights. Targets slightly inside 0 and 1 keep it finite. Source: Platt 1999.
Calibration calibrate(const Judged& judged) {
  MultinomialData data;
  data.num_outcomes = 2;
  std::vector<double> scores;
  const auto add = [&](const std::vector<double>& of_class, int outcome) {
    const auto n = static_cast<double>(of_class.size());
    for (const double score : of_class) {
      for (const int told : {outcome, 1 - outcome}) {
        scores.push_back(score);
        data.outcomes.push_back(told);
        data.shares.push_back((told == outcome ? n + 1.0 : 1.0) / (n + 2.0) / n);
      }
    }
  };
  add(judged.trunk, 0);
  add(judged.other, 1);
  data.features.setOnes(2, static_cast<Eigen::Index>(scores.size()));
  data.features.row(1) = Eigen::Map<const Eigen::RowVectorXd>(scores.data(), data.features.cols());
  const Eigen::MatrixXd beta = fit_multinomial(data, Eigen::Vector2d::Constant(kNoRidge)).weights;
  return {beta(0), beta(1)};
}

/// Applies to every fold the fit to all others. Fills the figures of `found` and its left_out, and
/// returns the calibration of the log odds.
Calibration cross_validate(const std::vector<AppearanceSample>& samples,
                           const std::vector<Fold>& folds, const Shape& shape,
                           AppearanceFit& found) {
  Judged judged;
  found.left_out.assign(samples.size(), std::numeric_limits<double>::quiet_NaN());
  for (const Fold& fold : folds) {
    const vision::AppearanceConfig config = fit(fold.outside, shape);
    judged.add(fold.inside, config);
    for (const AppearanceSample* sample : fold.inside) {
      found.left_out[static_cast<std::size_t>(sample - samples.data())] =
          vision::appearance_log_odds(sample->features, config);
    }
  }
  if (folds.empty()) return {};
  found.area = geometry::roc_area(judged.trunk, judged.other);
  const Calibration c = calibrate(judged);
  for (double& score : found.left_out) score = c.offset + c.slope * score;
  for (const double score : judged.trunk) {
    found.log_loss +=
        0.5 * loss_of(c.offset + c.slope * score) / static_cast<double>(judged.trunk.size());
  }
  for (const double score : judged.other) {
    found.log_loss +=
        0.5 * loss_of(-c.offset - c.slope * score) / static_cast<double>(judged.other.size());
  }
  return c;
}

void check(const std::vector<AppearanceSample>& samples, const AppearanceFit& found) {
  if (found.num_trunk < kMinWindows || found.num_other < kMinWindows) {
    throw std::runtime_error("there are " + std::to_string(found.num_trunk) +
                             " windows on trunks and " + std::to_string(found.num_other) +
                             " elsewhere, but at least " + std::to_string(kMinWindows) +
                             " of each are needed to learn what trunks look like");
  }
  for (const AppearanceSample& sample : samples) {
    for (const double value : sample.features) {
      if (!std::isfinite(value)) throw std::runtime_error("a feature of a window is not a number");
    }
  }
}

}  // namespace

AppearanceFit learn_appearance(const std::vector<AppearanceSample>& samples,
                               const AppearanceLearnOptions& options) {
  AppearanceFit found;
  std::set<int> groups;
  for (const AppearanceSample& sample : samples) {
    ++(sample.is_trunk ? found.num_trunk : found.num_other);
    groups.insert(sample.group);
  }
  check(samples, found);
  found.num_groups = static_cast<int>(groups.size());
  const std::vector<Fold> folds = deal_folds(samples, options.max_folds);
  const Shape shape = choose_shape(folds, options);
  found.penalty = shape.penalty;
  const Calibration calibration = cross_validate(samples, folds, shape, found);
  Samples all;
  for (const AppearanceSample& sample : samples) all.push_back(&sample);
  found.config = fit(all, shape);
  for (double& weight : found.config.weights) weight *= calibration.slope;
  for (double& weight : found.config.squares) weight *= calibration.slope;
  found.config.bias = calibration.offset + calibration.slope * found.config.bias;
  return found;
}

}  // namespace orchard::calibration
