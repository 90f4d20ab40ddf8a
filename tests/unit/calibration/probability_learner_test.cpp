// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/probability_learner.hpp"

#include <gtest/gtest.h>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "calibration/trunks/landmark_outcomes.hpp"
#include "calibration/trunks/multinomial.hpp"
#include "geometry/angles.hpp"
#include "simulation/random.hpp"
#include "unit/central_difference.hpp"
#include "worlds/landmark.hpp"

namespace orchard::calibration {
namespace {

using detection::Detection;
using detection::Label;

TEST(MultinomialFit, RecoversTheWeightsThatMadeTheData) {
  simulation::Random random(11);
  const double a[3] = {0.5, 1.5, -1.0}, b[3] = {-0.3, -0.7, 0.8};
  MultinomialData data;
  const int n = 20000;
  data.features.resize(3, n);
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector3d x(1.0, random.normal(), random.normal());
    data.features.col(i) = x;
    const double ea = std::exp(a[0] + a[1] * x[1] + a[2] * x[2]);
    const double eb = std::exp(b[0] + b[1] * x[1] + b[2] * x[2]);
    const double u = random.uniform() * (1.0 + ea + eb);
    data.outcomes.push_back(u < ea ? 0 : u < ea + eb ? 1 : 2);
    data.clusters.push_back(i);
  }
  const MultinomialFit fit = fit_multinomial(data, Eigen::Vector3d::Constant(1e-6));
  for (int k = 0; k < 3; ++k) {
    for (const auto& [column, truth] : {std::pair{0, a[k]}, std::pair{1, b[k]}}) {
      const double se = fit.standard_errors(k, column);
      EXPECT_NEAR(fit.weights(k, column), truth, 4.0 * se) << k << " " << column;
      EXPECT_GT(se, 0.005);
      EXPECT_LT(se, 0.06);
    }
  }
}

// At the optimum the slope is zero, and the sandwich's bread is the inverse of the slope's slope:
// both by central differences of the likelihood as its definition has it.
TEST(MultinomialFit, SlopeAndHessianAreTheCentralDifferences) {
  simulation::Random random(13);
  constexpr int kNum = 60;
  constexpr double kPenalty = 0.5;
  MultinomialData data;
  data.features.resize(2, kNum);
  for (int i = 0; i < kNum; ++i) {
    data.features.col(i) = Eigen::Vector2d(1.0, random.normal());
    data.outcomes.push_back(static_cast<int>(3.0 * random.uniform()));
    data.clusters.push_back(i / 3);
  }
  /// Log likelihood of one cluster, or of all with the penalty.
  const auto likelihood = [&](const Eigen::VectorXd& w, int cluster) {
    double sum = 0.0;
    for (int i = 0; i < kNum; ++i) {
      if (cluster >= 0 && data.clusters[static_cast<std::size_t>(i)] != cluster) continue;
      const double a = w.head<2>().dot(data.features.col(i));
      const double b = w.tail<2>().dot(data.features.col(i));
      const int outcome = data.outcomes[static_cast<std::size_t>(i)];
      sum += (outcome == 0   ? a
              : outcome == 1 ? b
                             : 0.0) -
             std::log(1.0 + std::exp(a) + std::exp(b));
    }
    return cluster >= 0 ? sum : sum - 0.5 * kPenalty * w.squaredNorm();
  };
  const auto slope_of = [&](const Eigen::VectorXd& w, int cluster) -> Eigen::VectorXd {
    return test::central_difference(
               [&](const Eigen::VectorXd& x) {
                 return Eigen::VectorXd::Constant(1, likelihood(x, cluster));
               },
               w, 1e-3)
        .J.row(0)
        .transpose();
  };
  const MultinomialFit fit = fit_multinomial(data, Eigen::Vector2d::Constant(kPenalty));
  const Eigen::VectorXd w = Eigen::Map<const Eigen::VectorXd>(fit.weights.data(), 4);
  EXPECT_LT(slope_of(w, -1).norm(), 1e-3);
  const Eigen::MatrixXd hessian =
      test::central_difference([&](const Eigen::VectorXd& x) { return slope_of(x, -1); }, w, 1e-3)
          .J;
  Eigen::MatrixXd meat = Eigen::MatrixXd::Zero(4, 4);
  for (int cluster = 0; cluster < kNum / 3; ++cluster) {
    const Eigen::VectorXd score = slope_of(w, cluster);
    meat += score * score.transpose();
  }
  const Eigen::MatrixXd bread = hessian.inverse();
  const Eigen::VectorXd expected = (bread * meat * bread).diagonal().cwiseSqrt();
  const Eigen::VectorXd found = Eigen::Map<const Eigen::VectorXd>(fit.standard_errors.data(), 4);
  EXPECT_LT((found - expected).norm(), 1e-4 * expected.norm());
}

TEST(MultinomialFit, ACopyOfEachObservationMakesNobodySurer) {
  simulation::Random random(12);
  MultinomialData once, twice;
  once.features.resize(2, 500);
  twice.features.resize(2, 1000);
  for (int i = 0; i < 500; ++i) {
    once.features.col(i) = Eigen::Vector2d(1.0, random.normal());
    once.outcomes.push_back(static_cast<int>(3.0 * random.uniform()));
    once.clusters.push_back(i);
    for (int copy = 0; copy < 2; ++copy) {
      twice.features.col(2 * i + copy) = once.features.col(i);
      twice.outcomes.push_back(once.outcomes.back());
      twice.clusters.push_back(i);
    }
  }
  const Eigen::Vector2d ridge = Eigen::Vector2d::Constant(1e-6);
  const auto a = fit_multinomial(once, ridge), b = fit_multinomial(twice, ridge);
  EXPECT_TRUE(a.weights.isApprox(b.weights, 1e-5));
  EXPECT_TRUE(a.standard_errors.isApprox(b.standard_errors, 1e-5));
}

TEST(MultinomialFit, SeparableOrMissingOutcomesStayFinite) {
  MultinomialData data;
  data.features = Eigen::MatrixXd::Ones(2, 10);
  for (int i = 0; i < 10; ++i) {
    data.features(1, i) = i < 5 ? -1.0 : 1.0;
    data.outcomes.push_back(i < 5 ? 0 : 1);
    data.clusters.push_back(i);
  }
  EXPECT_TRUE(fit_multinomial(data, Eigen::Vector2d::Ones()).weights.allFinite());
  const MultinomialData none{Eigen::MatrixXd(2, 0), {}, {}};
  EXPECT_TRUE(fit_multinomial(none, Eigen::Vector2d::Ones()).weights.isZero());
}

/// Looks at objects of a class each: the class decides colour and width, with overlap; some are of
/// the laser only.
std::vector<ProbabilitySample> observations(std::uint64_t seed, int num_recordings,
                                            int num_objects) {
  simulation::Random random(seed);
  std::vector<ProbabilitySample> samples;
  for (int recording = 0; recording < num_recordings; ++recording) {
    for (int object = 0; object < num_objects; ++object) {
      const bool is_tree = random.uniform() < 0.6;
      const double own = random.normal();  // what all observations of this object share
      for (int observation = 0; observation < 8; ++observation) {
        ProbabilitySample sample;
        sample.recording = recording;
        sample.object = object;
        sample.outcome = is_tree ? Outcome::kTree : Outcome::kObject;
        Detection& d = sample.detection;
        d.range_m = random.uniform(1.0, 4.0);
        d.num_beams = static_cast<int>(30.0 / d.range_m);
        d.width_m = 0.1 + (is_tree ? 0.0 : 0.015) + 0.01 * random.normal();
        d.roc_laser = std::exp(-0.5 * std::pow((d.width_m - 0.1) / 0.01, 2));
        d.label = observation == 0 ? Label::kUnseen : Label::kObject;
        if (observation > 0) {
          const double score = (is_tree ? 1.0 : -1.0) + own + random.normal();
          d.roc_colour = static_cast<float>(1.0 / (1.0 + std::exp(-score)));
          d.roc_edges = static_cast<float>(random.uniform(0.2, 0.9));
        }
        samples.push_back(sample);
      }
    }
  }
  return samples;
}

double calibration_error(const std::vector<ProbabilitySample>& samples,
                         const detection::ProbabilityConfig& config) {
  double sum[10] = {}, hits[10] = {}, error = 0.0;
  for (const ProbabilitySample& s : samples) {
    const double p = detection::tree_probability(s.detection, 0.1, config).tree;
    const int bin = std::min(9, static_cast<int>(10.0 * p));
    sum[bin] += p;
    hits[bin] += s.outcome == Outcome::kTree ? 1.0 : 0.0;
  }
  for (int i = 0; i < 10; ++i) error += std::abs(sum[i] - hits[i]);
  return error / static_cast<double>(samples.size());
}

TEST(ProbabilityLearner, IsCalibratedOnObservationsItNeverSaw) {
  const ProbabilityFit fit = learn_probability(observations(1, 5, 60), {0.1, 1.0, 10});
  EXPECT_LT(calibration_error(observations(2, 5, 60), fit.config), 0.05);
  EXPECT_EQ(fit.num_recordings, 5);
  EXPECT_EQ(fit.num_laser, 300);
  EXPECT_EQ(fit.num_judged, 2100);
  EXPECT_NEAR(fit.base_rate, 0.6, 0.06);
}

TEST(ProbabilityLearner, MoreColourIsMoreTree) {
  const ProbabilityFit fit = learn_probability(observations(1, 5, 60), {0.1, 1.0, 10});
  Detection d = observations(1, 1, 1)[1].detection;
  double last = 0.0;
  for (const float colour : {0.02f, 0.2f, 0.5f, 0.8f, 0.98f}) {
    d.roc_colour = colour;
    const auto p = detection::tree_probability(d, 0.1, fit.config);
    EXPECT_GT(p.tree, last);
    EXPECT_LE(p.tree + p.object, 1.0);
    last = p.tree;
  }
}

TEST(ProbabilityLearner, ObservationsThatFractionTheirErrorsCountForLess) {
  std::vector<ProbabilitySample> alike = observations(3, 5, 60);
  const ProbabilityFit of_alike = learn_probability(alike, {0.1, 1.0, 10});
  EXPECT_GT(of_alike.correlation, 0.1);
  // the same looks shared out anew within each class are independent
  std::vector<int> objects[2];
  for (const auto& s : alike) objects[s.outcome == Outcome::kTree].push_back(s.object);
  std::vector<ProbabilitySample> shuffled;
  for (const bool tree : {true, false}) {
    std::vector<ProbabilitySample> own;
    for (const auto& s : alike) {
      if ((s.outcome == Outcome::kTree) == tree) own.push_back(s);
    }
    simulation::Random random(7);
    for (std::size_t i = own.size(); i > 1; --i) {
      std::swap(own[i - 1].detection, own[random.bits() % i].detection);
    }
    shuffled.insert(shuffled.end(), own.begin(), own.end());
  }
  EXPECT_LT(learn_probability(shuffled, {0.1, 1.0, 10}).correlation, of_alike.correlation);
}

/// Mean log loss of an honest judge: weights on observations they were not learnt from [nat].
double loss_of(const std::vector<ProbabilitySample>& samples,
               const detection::ProbabilityConfig& config) {
  double loss = 0.0;
  for (const ProbabilitySample& s : samples) {
    const auto p = detection::tree_probability(s.detection, 0.1, config);
    loss -= std::log(std::max(1e-12, s.outcome == Outcome::kTree ? p.tree : p.object));
  }
  return loss / static_cast<double>(samples.size());
}

TEST(ProbabilityLearner, OneRecordingStatesTheLossOfObjectsItNeverSaw) {
  // Sixteen objects of eight alike observations each: the training data flatter the fit.
  double trained = 0.0, stated = 0.0, fresh = 0.0;
  constexpr int kNum = 20;
  for (std::uint64_t seed = 1; seed <= kNum; ++seed) {
    const auto samples = observations(seed, 1, 16);
    const ProbabilityFit fit = learn_probability(samples, {0.1, 1.0, 10});
    EXPECT_EQ(fit.left_out, LeftOut::kObjects);
    trained += loss_of(samples, fit.config) / kNum;
    stated += fit.log_loss / kNum;
    fresh += loss_of(observations(seed + 1000, 1, 200), fit.config) / kNum;
  }
  EXPECT_GT(fresh, 1.3 * trained);
  EXPECT_NEAR(stated, fresh, 0.25 * fresh);
}

TEST(ProbabilityLearner, LeavesOutRecordingsObjectsOrSaysThatItCannot) {
  EXPECT_EQ(learn_probability(observations(1, 3, 30), {}).left_out, LeftOut::kRecordings);
  auto one_tree = observations(1, 1, 30);
  for (auto& s : one_tree) {
    if (s.outcome == Outcome::kTree) s.object = 100;
  }
  EXPECT_EQ(learn_probability(one_tree, {}).left_out, LeftOut::kNothing);
  // False alarms belong to no object; they are left out, too.
  auto samples = observations(1, 1, 30);
  for (auto& s : samples) {
    if (s.outcome == Outcome::kObject) s.outcome = Outcome::kNeither, s.object = -1;
  }
  const ProbabilityFit fit = learn_probability(samples, {});
  EXPECT_EQ(fit.left_out, LeftOut::kObjects);
  for (std::size_t i = 0; i < samples.size(); ++i) EXPECT_GE(fit.left_out_tree[i], 0.0) << i;
}

TEST(ProbabilityLearner, RefusesTooLittle) {
  auto few = observations(1, 1, 2);
  EXPECT_THROW(learn_probability(few, {}), std::runtime_error);
  EXPECT_THROW(learn_probability({}, {}), std::runtime_error);
}

TEST(DecisionErrors, CountsWhatIsLabelledAgainstTheOutcome) {
  std::vector<ProbabilitySample> samples(5);
  ProbabilityFit fit;
  const auto set = [&](std::size_t i, Label label, double probability, Outcome outcome) {
    samples[i].detection.label = label;
    samples[i].outcome = outcome;
    fit.left_out_tree.push_back(probability);
  };
  set(0, Label::kTree, 0.9, Outcome::kTree);      // both right
  set(1, Label::kObject, 0.8, Outcome::kTree);    // roc wrong
  set(2, Label::kTree, 0.7, Outcome::kNeither);   // both wrong
  set(3, Label::kUnseen, 0.9, Outcome::kObject);  // not decided
  set(4, Label::kObject, 0.6, Outcome::kObject);  // probability wrong
  const DecisionErrors errors = decision_errors(samples, fit);
  EXPECT_EQ(errors.num, 4);
  EXPECT_EQ(errors.roc, 2);
  EXPECT_EQ(errors.probability, 2);
  fit.config.tree_min = 0.75;
  EXPECT_EQ(decision_errors(samples, fit).probability, 0);
}

TEST(ObjectLandmarks, HaveTheClassAndTheErrorOfTheirObservations) {
  std::vector<TrunkObservation> observations(5);
  TrunkModel model;
  model.objects.resize(4);
  const double x_m[] = {1.0, 1.2};
  for (std::size_t i = 0; i < 5; ++i) observations[i].in_map = i != 4;
  observations[0].x_m = x_m[0];
  observations[1].x_m = x_m[1];
  const auto set = [&](std::size_t object, std::vector<std::size_t> seen) {
    model.objects[object].num_observations = static_cast<int>(seen.size());
    model.objects[object].observations = std::move(seen);
  };
  set(0, {0, 1});
  model.objects[0].is_trunk = true;
  model.objects[0].x_m = 1.1;
  set(1, {2});
  model.objects[1].is_doubtful = true;
  set(2, {3});
  model.objects[2].log = 1;
  set(3, {4});  // without a pose
  const auto landmarks = object_landmarks(model, observations, 0);
  ASSERT_EQ(landmarks.size(), 2u);
  EXPECT_EQ(landmarks[0].label, Label::kTree);
  EXPECT_NEAR(landmarks[0].se_x_m, 0.1, 1e-12);  // 0.2 m apart: sd 0.1414 m, over root 2
  EXPECT_EQ(landmarks[0].se_y_m, 0.0);
  EXPECT_EQ(landmarks[1].label, Label::kUnseen);
  const auto others = object_landmarks(model, observations, 1);
  ASSERT_EQ(others.size(), 1u);
  EXPECT_EQ(others[0].label, Label::kObject);
}

using detection::Detections;
using mapping::Candidate;
using mapping::Landmark;

Landmark landmark(Label label, double x_m, double y_m, double width_m) {
  Landmark l = test::landmark(0, label, x_m, y_m, width_m, 25);
  l.se_x_m = l.se_y_m = 0.002;  // observations scatter by 10 mm
  return l;
}

std::vector<LandmarkMatch> match(const std::vector<Landmark>& landmarks,
                                 const std::vector<Eigen::Vector2d>& places_map,
                                 double sd_m = 0.01) {
  std::vector<Candidate> scan;
  for (const Eigen::Vector2d& p_map : places_map) {
    Candidate candidate;
    candidate.p_map = candidate.p_aligned = p_map;
    candidate.covariance = candidate.aligned_covariance = sd_m * sd_m * Eigen::Matrix2d::Identity();
    scan.push_back(candidate);
  }
  return LandmarkOutcomes(landmarks, {}).match(scan);
}

TEST(LandmarkOutcomes, TheGateEndsWhereItsKeySays) {
  const double gate_m = mapping::MapperConfig().gate_m;
  const std::vector<Landmark> map{landmark(Label::kTree, 5.0, -3.0, 0.1)};
  EXPECT_EQ(match(map, {{5.0 + gate_m - 1e-6, -3.0}})[0].landmark, 0);
  EXPECT_EQ(match(map, {{5.0 + gate_m + 1e-6, -3.0}})[0].landmark, -1);
  EXPECT_EQ(match(map, {{5.0, -3.0 - gate_m - 1e-6}})[0].landmark, -1);
  EXPECT_TRUE(match({}, {}).empty());
  EXPECT_EQ(match({}, {{0.0, 0.0}})[0].landmark, -1);
}

TEST(LandmarkOutcomes, AWideObjectReachesToItsBorderAndAHedgeAlongItsLength) {
  const std::vector<Landmark> bush{landmark(Label::kObject, 0.0, 0.0, 1.6)};
  EXPECT_EQ(match(bush, {{0.79, 0.0}})[0].landmark, 0);
  EXPECT_EQ(match(bush, {{0.81, 0.0}})[0].landmark, -1);
  // The mapper reports nothing wider than 2 m whole: such a width is a mistake.
  EXPECT_EQ(match({landmark(Label::kObject, 0.0, 0.0, 50.0)}, {{1.01, 0.0}})[0].landmark, -1);
  Landmark hedge = landmark(Label::kObject, 0.0, 0.0, 0.8);
  hedge.length_m = 10.0;
  hedge.direction_rad = 0.5 * geometry::kPi;
  EXPECT_EQ(match({hedge}, {{0.35, 4.5}})[0].landmark, 0);
  EXPECT_EQ(match({hedge}, {{4.5, 0.35}})[0].landmark, -1);
  EXPECT_EQ(match({hedge}, {{0.0, 5.1}})[0].landmark, -1);
}

TEST(LandmarkOutcomes, OnlyWhatFitsATreeAndAnObjectIsDoubtful) {
  const std::vector<Landmark> map{landmark(Label::kTree, 0.0, 0.0, 0.1),
                                  landmark(Label::kObject, 0.25, 0.0, 0.1)};
  const LandmarkMatch sure = match(map, {{0.02, 0.0}})[0];
  EXPECT_EQ(sure.landmark, 0);
  EXPECT_FALSE(sure.is_doubtful) << "5 sd from the border of the object";
  EXPECT_TRUE(match(map, {{0.02, 0.0}}, 0.1)[0].is_doubtful) << "2 sd of a worse detection";
  EXPECT_FALSE(match(map, {{0.24, 0.0}})[0].is_doubtful);
  EXPECT_TRUE(match(map, {{0.12, 0.15}})[0].is_doubtful) << "in the gates of both, at neither";
  const std::vector<Landmark> two_trees{map[0], landmark(Label::kTree, 0.25, 0.0, 0.1)};
  EXPECT_FALSE(match(two_trees, {{0.12, 0.15}})[0].is_doubtful);
  EXPECT_EQ(match(two_trees, {{0.13, 0.15}})[0].landmark, 1) << "the nearer";
  EXPECT_TRUE(match({landmark(Label::kUnseen, 0.0, 0.0, 0.1)}, {{0.0, 0.0}})[0].is_doubtful);
}

TEST(LandmarkOutcomes, ATreeIsObservedOnceAScanAndABushInParts) {
  const std::vector<Eigen::Vector2d> parts{{0.2, 0.0}, {0.01, 0.0}, {0.0, -0.25}};
  const auto of_tree = match({landmark(Label::kTree, 0.0, 0.0, 0.1)}, parts);
  EXPECT_EQ(of_tree[0].landmark, -1);
  EXPECT_EQ(of_tree[1].landmark, 0);
  EXPECT_EQ(of_tree[2].landmark, -1);
  for (const LandmarkMatch& found : match({landmark(Label::kObject, 0.0, 0.0, 0.6)}, parts)) {
    EXPECT_EQ(found.landmark, 0);
  }
}

/// A robot that turns by 1 rad/s while its beams sweep for 80 ms: the pose at a time, in closed
/// form.
pose::PoseEstimate pose_at(std::int64_t utime) {
  const double t_s = 1e-6 * static_cast<double>(utime);
  pose::PoseEstimate pose;
  pose.utime = utime;
  pose.x_m = 100.0 + 1.2 * t_s;
  pose.y_m = -50.0;
  pose.yaw_rad = 1.0 * t_s;
  return pose;
}

/// What it observes of a map point at a time: the inverse of its pose.
Detection observed(const Eigen::Vector2d& p_map, std::int64_t utime) {
  const pose::PoseEstimate pose = pose_at(utime);
  const Eigen::Vector2d arm = p_map - Eigen::Vector2d(pose.x_m, pose.y_m);
  const double c = std::cos(pose.yaw_rad), s = std::sin(pose.yaw_rad);
  Detection d;
  d.utime = utime;
  d.centre_x_m = c * arm.x() + s * arm.y();
  d.centre_y_m = -s * arm.x() + c * arm.y();
  d.covariance = {1e-4, 0.0, 1e-4};
  d.width_m = 0.1;
  return d;
}

TEST(LandmarkSamples, AMovingRobotsDetectionsGetTheOutcomeOfWhatStandsThere) {
  // 8 m away, 0.08 rad of a sweep are 0.64 m: without the pose of its own beam, nothing fits.
  const Eigen::Vector2d tree(108.0, -49.0), crate(104.0, -57.0), shadow(98.0, -46.0);
  const LandmarkOutcomes outcomes(
      {landmark(Label::kTree, tree.x(), tree.y(), 0.1),
       landmark(Label::kObject, crate.x(), crate.y(), 0.5), landmark(Label::kTree, 0.0, 0.0, 0.1)},
      {});
  std::vector<pose::PoseEstimate> path;
  for (std::int64_t utime = 0; utime <= 2'000'000; utime += 20'000) path.push_back(pose_at(utime));
  std::vector<Detections> messages;
  for (std::int64_t utime = 100'000; utime < 1'900'000; utime += 100'000) {
    Detections message;
    message.utime = utime;
    message.trunks = {observed(crate, utime + 10'000), observed(tree, utime + 50'000),
                      observed(shadow, utime + 80'000)};
    messages.push_back(message);
  }
  messages.push_back({60'000'000, 0, 0, {observed(tree, 60'000'000)}});  // after the last pose
  const auto samples = landmark_samples(messages, path, outcomes, {}, 7);
  ASSERT_EQ(samples.size(), 54u);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const ProbabilitySample& sample = samples[i];
    const Outcome truths[] = {Outcome::kObject, Outcome::kTree, Outcome::kNeither};
    const int objects[] = {1, 0, -1};
    EXPECT_EQ(sample.outcome, truths[i % 3]) << i;
    EXPECT_EQ(sample.object, objects[i % 3]) << i;
    EXPECT_EQ(sample.recording, 7);
    EXPECT_EQ(sample.detection.centre_x_m, messages[i / 3].trunks[i % 3].centre_x_m)
        << "learnt is what the detector sends";
  }
}

}  // namespace

}  // namespace orchard::calibration
