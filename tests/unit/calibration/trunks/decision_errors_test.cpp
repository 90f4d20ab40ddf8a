// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/decision_errors.hpp"

#include <gtest/gtest.h>

#include "calibration/trunks/object_landmarks.hpp"

namespace orchard::calibration {
namespace {

using detection::Label;

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

}  // namespace
}  // namespace orchard::calibration
