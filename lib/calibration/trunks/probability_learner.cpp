// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/probability_learner.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "calibration/trunks/multinomial.hpp"
#include "mapping/landmark_record.hpp"

namespace orchard::calibration {
namespace {

using detection::ViewKind;

// derived: two observations for each of ten features; steps of 0.02.
constexpr int kMinOfAKind = 20;
constexpr int kCorrelationSteps = 50;

using ObjectKey = std::pair<int, int>;  // recording, index in its truth

/// Converts the observations of one kind to regression data.
MultinomialData data_of(const std::vector<ProbabilitySample>& samples, ViewKind view,
                        std::size_t num_features, const ProbabilityLearnOptions& options,
                        const std::vector<char>& is_kept) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (is_kept[i] && detection::view_kind(samples[i].detection) == view) rows.push_back(i);
  }
  MultinomialData data;
  data.features.resize(static_cast<Eigen::Index>(num_features),
                       static_cast<Eigen::Index>(rows.size()));
  std::map<ObjectKey, int> clusters;
  int next = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const ProbabilitySample& sample = samples[rows[k]];
    const auto features = detection::probability_features(sample.detection, options.width_mean_m);
    for (std::size_t f = 0; f < num_features; ++f) {
      data.features(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(k)) = features[f];
    }
    data.outcomes.push_back(static_cast<int>(sample.outcome));
    // A false alarm, which belongs to no object, is a separate cluster.
    int cluster = next++;
    if (sample.object >= 0) {
      cluster = clusters.try_emplace({sample.recording, sample.object}, cluster).first->second;
    }
    data.clusters.push_back(cluster);
  }
  return data;
}

FittedWeights column(const MultinomialFit& fit, Eigen::Index outcome) {
  const Eigen::VectorXd w = fit.weights.col(outcome), se = fit.standard_errors.col(outcome);
  return {{w.data(), w.data() + w.size()}, {se.data(), se.data() + se.size()}};
}

ProbabilityFit fit_weights(const std::vector<ProbabilitySample>& samples,
                           const ProbabilityLearnOptions& options,
                           const std::vector<char>& is_kept) {
  const auto judged =
      data_of(samples, ViewKind::kJudged, detection::kNumJudgedFeatures, options, is_kept);
  const auto laser =
      data_of(samples, ViewKind::kLaserOnly, detection::kNumLaserFeatures, options, is_kept);
  const auto fit_of = [&](const MultinomialData& data) {
    return fit_multinomial(data, Eigen::VectorXd::Constant(data.features.rows(), options.penalty));
  };
  const auto of_judged = fit_of(judged), of_laser = fit_of(laser);
  ProbabilityFit fit;
  fit.num_judged = static_cast<int>(judged.outcomes.size());
  fit.num_laser = static_cast<int>(laser.outcomes.size());
  fit.judged_tree = column(of_judged, 0);
  fit.judged_object = column(of_judged, 1);
  fit.laser_tree = column(of_laser, 0);
  fit.laser_object = column(of_laser, 1);
  fit.config = {true, fit.judged_tree.values, fit.judged_object.values, fit.laser_tree.values,
                fit.laser_object.values};
  return fit;
}

/// The evidence of all observations of one object, summed as in the mapper.
struct ObjectEvidence {
  bool is_tree = false;
  double labelled_sum = 0.0, unseen_sum = 0.0;
  int num_labelled = 0, num_unseen = 0;
};

/// Log loss over objects: mean and its standard error.
struct ObjectLoss {
  double mean = 0.0, standard_error = 0.0;
};

ObjectLoss loss_of_objects(const std::map<ObjectKey, ObjectEvidence>& objects,
                           const mapping::MapperConfig& config) {
  double sum = 0.0, sum2 = 0.0;
  for (const auto& [key, object] : objects) {
    const bool labelled = object.num_labelled > 0;
    const double log_odds =
        mapping::log_odds_of_tree(labelled ? object.labelled_sum : object.unseen_sum,
                                  labelled ? object.num_labelled : object.num_unseen, config);
    const double loss = std::log1p(std::exp(object.is_tree ? -log_odds : log_odds));
    sum += loss;
    sum2 += loss * loss;
  }
  const auto n = static_cast<double>(std::max<std::size_t>(1, objects.size()));
  return {sum / n, std::sqrt(std::max(0.0, sum2 / n - sum * sum / (n * n)) / n)};
}

/// Fits prior and correlation. The prior is the fraction of trees among the objects. The
/// correlation is the largest whose log loss is within one standard error of the best: few objects
/// are misclassified, so the minimum alone would give overconfident probabilities.
void fit_evidence(const std::vector<ProbabilitySample>& samples,
                  const std::vector<double>& probabilities, ProbabilityFit& fit) {
  double num_trees = 0.0, num = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (probabilities[i] < 0.0) continue;
    num += 1.0;
    num_trees += samples[i].outcome == Outcome::kTree ? 1.0 : 0.0;
  }
  mapping::MapperConfig config;
  config.evidence = mapping::Evidence::kProbability;
  fit.base_rate = config.evidence_base_rate = std::clamp(num_trees / num, 0.02, 0.98);
  std::map<ObjectKey, ObjectEvidence> objects;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const ProbabilitySample& sample = samples[i];
    if (probabilities[i] < 0.0 || sample.object < 0) continue;
    ObjectEvidence& object = objects[{sample.recording, sample.object}];
    object.is_tree = sample.outcome == Outcome::kTree;
    detection::Detection observation = sample.detection;
    observation.probability_tree = static_cast<float>(probabilities[i]);
    observation.probability_object = static_cast<float>(1.0 - probabilities[i]);
    // As in the mapper: UNSEEN observations count only while there is no labelled one.
    const bool labelled = observation.label != detection::Label::kUnseen;
    (labelled ? object.labelled_sum : object.unseen_sum) +=
        mapping::evidence_of(observation, config);
    ++(labelled ? object.num_labelled : object.num_unseen);
  }
  fit.num_objects = static_cast<int>(objects.size());
  double num_tree_objects = 0.0;
  for (const auto& [key, object] : objects) num_tree_objects += object.is_tree ? 1.0 : 0.0;
  fit.prior = std::clamp((num_tree_objects + 1.0) / (static_cast<double>(objects.size()) + 2.0),
                         0.02, 0.98);
  config.evidence_prior = fit.prior;
  ObjectLoss best{std::numeric_limits<double>::infinity(), 0.0};
  for (int step = 0; step <= kCorrelationSteps; ++step) {
    config.evidence_correlation = static_cast<double>(step) / kCorrelationSteps;
    const ObjectLoss loss = loss_of_objects(objects, config);
    if (loss.mean < best.mean) best = loss;
  }
  for (int step = 0; step <= kCorrelationSteps; ++step) {
    config.evidence_correlation = static_cast<double>(step) / kCorrelationSteps;
    if (loss_of_objects(objects, config).mean > best.mean + best.standard_error) continue;
    fit.correlation = config.evidence_correlation;
  }
}

void check(const std::vector<ProbabilitySample>& samples) {
  int num_trees = 0, num_others = 0;
  for (const ProbabilitySample& sample : samples) {
    if (detection::view_kind(sample.detection) != ViewKind::kJudged) continue;
    ++(sample.outcome == Outcome::kTree ? num_trees : num_others);
  }
  if (num_trees >= kMinOfAKind && num_others >= kMinOfAKind) return;
  throw std::runtime_error("there are " + std::to_string(num_trees) +
                           " observations of trees judged by the camera and " +
                           std::to_string(num_others) + " of other objects, but at least " +
                           std::to_string(kMinOfAKind) +
                           " of each are needed to learn probabilities");
}

double log_loss(const ProbabilitySample& sample, const detection::TreeProbability& p) {
  const double given = sample.outcome == Outcome::kTree     ? p.tree
                       : sample.outcome == Outcome::kObject ? p.object
                                                            : 1.0 - p.tree - p.object;
  return -std::log(std::max(given, 1e-12));
}

int num_recordings(const std::vector<ProbabilitySample>& samples) {
  std::set<int> recordings;
  for (const ProbabilitySample& sample : samples) recordings.insert(sample.recording);
  return static_cast<int>(recordings.size());
}

/// The parts that are left out of the fit in turn.
struct Folds {
  int num = 1;  ///< 1: nothing is left out
  LeftOut left_out = LeftOut::kNothing;
  std::vector<int> of_sample;
};

Folds recording_folds(const std::vector<ProbabilitySample>& samples, int max_folds) {
  std::map<int, int> fold_of;
  for (const ProbabilitySample& sample : samples) fold_of[sample.recording] = 0;
  Folds folds{std::min(static_cast<int>(fold_of.size()), max_folds), LeftOut::kRecordings, {}};
  int next = 0;
  for (auto& [recording, fold] : fold_of) fold = next++ % folds.num;
  for (const ProbabilitySample& sample : samples) {
    folds.of_sample.push_back(fold_of[sample.recording]);
  }
  return folds;
}

/// Deals out the trees, then the other objects, so that every fold has trees; what belongs to no
/// object is cut into stretches of equal number.
Folds object_folds(const std::vector<ProbabilitySample>& samples, int max_folds) {
  std::map<int, int> fold_of;
  std::set<int> trees, others;
  std::ptrdiff_t num_of_none = 0;
  for (const ProbabilitySample& sample : samples) {
    num_of_none += sample.object < 0;
    if (sample.object >= 0)
      (sample.outcome == Outcome::kTree ? trees : others).insert(sample.object);
  }
  Folds folds{std::min(static_cast<int>(trees.size()), max_folds), LeftOut::kObjects, {}};
  if (folds.num < 2) return {1, LeftOut::kNothing, std::vector<int>(samples.size(), 0)};
  for (const std::set<int>* kind : {&trees, &others}) {
    int next = 0;
    for (const int object : *kind) fold_of[object] = next++ % folds.num;
  }
  std::ptrdiff_t of_none = 0;
  for (const ProbabilitySample& sample : samples) {
    folds.of_sample.push_back(sample.object < 0
                                  ? static_cast<int>(of_none++ * folds.num / num_of_none)
                                  : fold_of[sample.object]);
  }
  return folds;
}

Folds folds_of(const std::vector<ProbabilitySample>& samples, int max_folds) {
  return num_recordings(samples) > 1 ? recording_folds(samples, max_folds)
                                     : object_folds(samples, max_folds);
}

}  // namespace

ProbabilityFit learn_probability(const std::vector<ProbabilitySample>& samples,
                                 const ProbabilityLearnOptions& options) {
  check(samples);
  const Folds folds = folds_of(samples, options.max_folds);
  std::vector<char> is_kept(samples.size(), 1);
  ProbabilityFit found = fit_weights(samples, options, is_kept);
  found.num_recordings = num_recordings(samples);
  found.left_out = folds.left_out;
  found.left_out_tree.assign(samples.size(), -1.0);
  double loss = 0.0;
  int num = 0;
  for (int fold = 0; fold < folds.num; ++fold) {
    detection::ProbabilityConfig config = found.config;
    if (folds.num > 1) {
      for (std::size_t i = 0; i < samples.size(); ++i) is_kept[i] = folds.of_sample[i] != fold;
      config = fit_weights(samples, options, is_kept).config;
    }
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (folds.of_sample[i] != fold) continue;
      if (detection::view_kind(samples[i].detection) == ViewKind::kHidden) continue;
      const auto p = tree_probability(samples[i].detection, options.width_mean_m, config);
      found.left_out_tree[i] = p.tree;
      loss += log_loss(samples[i], p);
      ++num;
    }
  }
  found.log_loss = loss / std::max(1, num);
  fit_evidence(samples, found.left_out_tree, found);
  return found;
}

DecisionErrors decision_errors(const std::vector<ProbabilitySample>& samples,
                               const ProbabilityFit& fit) {
  DecisionErrors errors;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const detection::Label label = samples[i].detection.label;
    if (label == detection::Label::kUnseen || fit.left_out_tree[i] < 0.0) continue;
    const bool is_tree = samples[i].outcome == Outcome::kTree;
    ++errors.num;
    errors.roc += is_tree != (label == detection::Label::kTree);
    errors.probability += is_tree != (fit.left_out_tree[i] >= fit.config.tree_min);
  }
  return errors;
}

}  // namespace orchard::calibration
