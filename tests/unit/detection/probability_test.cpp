// SPDX-License-Identifier: BSD-3-Clause
#include "detection/probability.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "detection/detect.hpp"
#include "unit/detection/tube_rig.hpp"

namespace orchard::detection {
namespace {

/// Only the bias and the colour speak.
ProbabilityConfig colour_alone() {
  ProbabilityConfig config;
  config.enabled = true;
  config.judged_tree = {2.0, 0, 0, 0, 0, 0, 1.0, 0, 0, 0};
  config.judged_object = {2.0, 0, 0, 0, 0, 0, -1.0, 0, 0, 0};
  config.laser_tree = {1.0, 0, 0, 0, 0, 0};
  config.laser_object = {0.0, 0, 0, 0, 0, 0};
  return config;
}

TEST(Probability, FeaturesComeFromTheMessage) {
  Detection d;
  d.width_m = 0.08;
  d.roc_laser = static_cast<float>(std::exp(-0.5 * 1.5 * 1.5));
  d.range_m = 2.5;
  d.num_beams = 20;
  d.occlusion = kOccludedLeft;
  d.roc_colour = 0.75f;
  d.roc_edges = 0.4f;
  const auto f = probability_features(d, 0.09);
  EXPECT_NEAR(f[1], -1.5, 1e-5);  // narrower than the mean
  EXPECT_NEAR(f[2], 0.45, 1e-5);
  EXPECT_NEAR(f[3], 2.5, 1e-9);
  EXPECT_NEAR(f[4], std::log(2.0), 1e-9);
  EXPECT_EQ(f[5], 1.0);
  EXPECT_NEAR(f[6], std::log(3.0), 1e-5);
  EXPECT_EQ(f[7], 0.0);
  EXPECT_NEAR(f[8], 0.4, 1e-6);
  d.width_m = 0.10;
  EXPECT_NEAR(probability_features(d, 0.09)[1], 1.5, 1e-5);
  d.roc_laser = 0.0;  // too far off for a float
  EXPECT_EQ(probability_features(d, 0.09)[1], 5.0);
}

TEST(Probability, IsTheLogisticOfItsScores) {
  Detection d;
  d.label = Label::kObject;
  d.roc_colour = 0.75f;
  const auto p = tree_probability(d, 0.09, colour_alone());
  const double tree = std::exp(2.0) * 3.0, object = std::exp(2.0) / 3.0;
  EXPECT_NEAR(p.tree, tree / (1.0 + tree + object), 1e-6);
  EXPECT_NEAR(p.object, object / (1.0 + tree + object), 1e-6);
}

TEST(Probability, WhatNothingJudgedIsUnknown) {
  Detection d;
  EXPECT_NEAR(tree_probability(d, 0.09, colour_alone()).tree, std::exp(1.0) / (2 + std::exp(1.0)),
              1e-9);  // whole, but only the laser's
  d.occlusion = kOccludedRight;
  const auto p = tree_probability(d, 0.09, colour_alone());
  EXPECT_EQ(p.tree + p.object, 0.0);
  EXPECT_EQ(tree_probability(d, 0.09, {}).tree, 0.0);
}

// What the laser refused has no colour because nobody looked: the camera's weights know nothing of
// it.
TEST(Probability, WhatTheLaserRefusedIsJudgedByTheLaser) {
  ProbabilityConfig config = colour_alone();
  config.judged_tree[7] = 50.0;  // "roc_colour is 0"
  Detection d;
  d.label = Label::kObject;
  EXPECT_EQ(view_kind(d), ViewKind::kLaserOnly);
  EXPECT_NEAR(tree_probability(d, 0.09, config).tree, std::exp(1.0) / (2 + std::exp(1.0)), 1e-9);
  d.roc_colour = 0.1f;
  EXPECT_EQ(view_kind(d), ViewKind::kJudged);
}

TEST(Probability, HugeWeightsStayInBounds) {
  ProbabilityConfig config = colour_alone();
  config.judged_tree[0] = 1000.0;
  Detection d;
  d.label = Label::kTree;
  d.roc_colour = 0.5f;
  const auto p = tree_probability(d, 0.09, config);
  EXPECT_EQ(p.tree, 1.0);
  EXPECT_EQ(p.object, 0.0);
}

TEST(Probability, DecidesWhereTheRigSaysSo) {
  DetectorConfig config;
  config.probability = colour_alone();
  const auto tubes = std::vector<test::Tube>{test::brown_tube(1.5, 0.3)};
  const auto label = [&](Decision decision, double bias) {
    config.decision = decision;
    config.probability.judged_tree[0] = bias;
    const Rig rig = test::tube_rig(config);
    const vision::Image image = test::picture_of_tubes(tubes, rig);
    const auto found = detect(test::scan_of(tubes), &image, rig).detections;
    EXPECT_EQ(found.trunks.size(), 1u);
    EXPECT_GT(found.trunks[0].probability_tree + found.trunks[0].probability_object, 0.0f);
    return found.trunks[0].label;
  };
  EXPECT_EQ(label(Decision::kProbability, 2.0), Label::kTree);
  EXPECT_EQ(label(Decision::kProbability, -3.0), Label::kTree);
  config.probability.tree_min = 0.99;
  EXPECT_EQ(label(Decision::kProbability, -3.0), Label::kObject);
  config.probability.tree_min = 0.5;
  EXPECT_EQ(label(Decision::kProbability, -20.0), Label::kObject);
  EXPECT_EQ(label(Decision::kRoc, -20.0), Label::kTree);
}

TEST(Probability, TheCameraIsAskedWhereverItsAnswerCouldDecide) {
  DetectorConfig config;
  config.decision = Decision::kProbability;
  config.probability = colour_alone();
  config.width.sd_m = 0.01;
  const auto found = [&](const test::Tube& tube) {
    const Rig rig = test::tube_rig(config);
    const vision::Image image = test::picture_of_tubes({tube}, rig);
    return detect(test::scan_of({tube}), &image, rig).detections.trunks.at(0);
  };
  // Four standard deviations too wide: the laser rejects both, only their colours differ.
  const test::Tube brown = test::brown_tube(1.5, 0.3, 0.13), blue = test::blue_tube(1.5, 0.3, 0.13);
  EXPECT_LT(found(brown).roc_laser, DetectorConfig::kRocLaserMin);
  EXPECT_EQ(found(brown).label, Label::kTree);
  EXPECT_GT(found(brown).roc_colour, 0.5f);
  EXPECT_EQ(found(blue).label, Label::kObject);

  // Where the width outweighs the best answer that a camera can give, no picture is looked at.
  config.probability.judged_tree[2] = -6.0;
  EXPECT_EQ(found(brown).roc_colour, 0.0f);
  EXPECT_EQ(found(brown).label, Label::kObject);
  // The paper's rule, too, asks the camera about trunks of the right width only.
  config.probability.judged_tree[2] = 0.0;
  config.decision = Decision::kRoc;
  EXPECT_EQ(found(brown).roc_colour, 0.0f);
  EXPECT_EQ(found(brown).label, Label::kObject);
}

}  // namespace
}  // namespace orchard::detection
