// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/detections/detection_evaluation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>
#include <nlohmann/json.hpp>

#include "experiments/windows/window_evaluation.hpp"

namespace orchard::evaluation {
namespace {

using detection::Detection;
using detection::Detections;
using detection::Label;
using simulation::TrueObservation;

constexpr double kMountX = 0.3, kMountY = -0.1, kMountYaw = 0.4;

TrueObservation thing(int object, Label label, double range_m, double bearing_rad) {
  TrueObservation t;
  t.utime = 1000;
  t.object = object;
  t.label = label;
  t.width_m = 0.1;
  t.range_m = range_m;
  t.bearing_rad = bearing_rad;
  t.num_beams = 10;
  t.in_picture = true;
  return t;
}

/// What a perfect detector would say of a thing, as its centre off by so much along the beam.
Detection detection_of(const TrueObservation& t, Label label, double off_m = 0.0) {
  Detection d;
  d.range_m = t.range_m;
  d.bearing_rad = t.bearing_rad;
  d.label = label;
  const double yaw = kMountYaw + t.bearing_rad;
  d.surface_x_m = kMountX + t.range_m * std::cos(yaw);
  d.surface_y_m = kMountY + t.range_m * std::sin(yaw);
  d.centre_x_m = kMountX + (t.range_m + 0.05 + off_m) * std::cos(yaw);
  d.centre_y_m = kMountY + (t.range_m + 0.05 + off_m) * std::sin(yaw);
  return d;
}

/// One scan by hand: three trees found (one 12 mm off, one 9 mm), one missed, one called OBJECT,
/// one UNSEEN; a post called TREE and nothing called TREE; and what does not count.
struct Scene {
  std::vector<TrueObservation> truth;
  std::vector<Detections> messages{Detections{}};

  Scene() {
    messages[0].utime = 1000;
    messages[0].image_utime = 1010;
    put(Label::kTree, 1.5, -1.0, Label::kTree, 0.012);
    put(Label::kTree, 2.5, -0.6, Label::kTree, -0.009);
    put(Label::kTree, 2.6, -0.3, Label::kTree);
    put(Label::kTree, 3.0, 0.0, std::nullopt);
    put(Label::kTree, 3.5, 0.3, Label::kObject);
    put(Label::kTree, 3.6, 0.6, Label::kUnseen);
    put(Label::kObject, 2.2, 0.9, Label::kTree);
    put(Label::kObject, 2.3, 1.2, Label::kObject);
    put(Label::kTree, 5.0, 1.5, Label::kTree);  // too far to count
    put(Label::kTree, 2.0, 1.8, Label::kTree);  // hidden: does not count
    truth.back().hidden_fraction = 0.6;
    put(Label::kTree, 2.0, 2.1, Label::kObject);  // not in the picture
    truth.back().in_picture = false;
    put(Label::kTree, 2.0, 2.4, Label::kUnseen);  // two beams
    truth.back().num_beams = 2;
    messages[0].trunks.push_back(
        detection_of(thing(99, Label::kTree, 3.0, -1.8), Label::kTree));  // nothing stands there
  }

  void put(Label label, double range_m, double bearing_rad, std::optional<Label> said,
           double off_m = 0.0) {
    truth.push_back(thing(static_cast<int>(truth.size()), label, range_m, bearing_rad));
    if (said) messages[0].trunks.push_back(detection_of(truth.back(), *said, off_m));
  }
};

TEST(DetectionEvaluation, CountsAsAPersonWouldByHand) {
  const Scene scene;
  const ObservationPairs found = pair_observations(scene.messages, scene.truth, 0);
  EXPECT_EQ(found.num_scans, 1);
  const Counts c = count_labels(found.pairs, {});
  EXPECT_EQ(c.num_right, 3);
  EXPECT_EQ(c.num_wrong, 2);
  EXPECT_EQ(c.num_wrong_on_object, 1);
  EXPECT_EQ(c.num_missed, 3);
  EXPECT_EQ(c.num_not_detected, 1);
  EXPECT_EQ(c.num_unseen, 1);
  EXPECT_DOUBLE_EQ(c.precision(), 0.6);
  EXPECT_DOUBLE_EQ(c.recall(), 0.5);
  EXPECT_DOUBLE_EQ(c.f1(), 6.0 / 11.0);
}

TEST(DetectionEvaluation, RulesDecideWhatCounts) {
  const Scene scene;
  const auto observations = pair_observations(scene.messages, scene.truth, 0).pairs;
  DetectionRules rules;
  rules.range_max_m = 6.0;
  EXPECT_EQ(count_labels(observations, rules).num_right, 4);
  rules.hidden_max = 1.0;
  EXPECT_EQ(count_labels(observations, rules).num_right, 5);
  rules.num_beams_min = 1;
  EXPECT_EQ(count_labels(observations, rules).num_unseen, 2);
  rules.in_picture = false;
  EXPECT_EQ(count_labels(observations, rules).num_missed, 5);
}

TEST(DetectionEvaluation, CentreErrorsSeeThroughTheMount) {
  const Scene scene;
  const auto observations = pair_observations(scene.messages, scene.truth, 0).pairs;
  const ErrorStatistics near = centre_errors(observations, {}, 1.0, 2.0);
  EXPECT_EQ(near.num, 1);
  EXPECT_NEAR(near.rmse, 0.012, 1e-9);
  const ErrorStatistics far = centre_errors(observations, {}, 2.0, 3.0);
  EXPECT_EQ(far.num, 2);
  EXPECT_NEAR(far.rmse, 0.009 / std::sqrt(2.0), 1e-9);
}

TEST(DetectionEvaluation, ScansAreMatchedByTime) {
  Scene scene;
  scene.messages[0].utime = 2000;
  const ObservationPairs found = pair_observations(scene.messages, scene.truth, 0);
  EXPECT_EQ(found.num_scans, 0);
  EXPECT_EQ(found.num_without_truth, 1);
  EXPECT_EQ(found.num_without_message, 1);
}

TEST(DetectionEvaluation, AScoreAloneIsJudgedAtItsBestThreshold) {
  // trees 0.9, 0.8, 0.3; others 0.5, 0.1: the best is 0.3 with one wrong (F1 6/7)
  std::vector<ObservationPair> observations;
  const auto add = [&](Label label, float roc_colour) {
    ObservationPair observation;
    observation.has_image = true;
    observation.truth = thing(0, label, 2.0, 0.0);
    observation.detection = detection_of(*observation.truth, Label::kObject);
    observation.detection->roc_colour = roc_colour;
    observations.push_back(observation);
  };
  for (const float roc : {0.9f, 0.8f, 0.3f}) add(Label::kTree, roc);
  for (const float roc : {0.5f, 0.1f}) add(Label::kObject, roc);
  const DetectionEvaluation e = evaluate_detections(observations, {"a"}, {});
  const ScoreTest& colour = e.tests[0];
  EXPECT_EQ(colour.name, "colour only");
  EXPECT_NEAR(colour.mean_of_trees, 2.0 / 3.0, 1e-6);
  EXPECT_NEAR(colour.mean_of_others, 0.3, 1e-6);
  EXPECT_NEAR(colour.area, 5.0 / 6.0, 1e-9);  // of six pairs one is the wrong way round
  EXPECT_FLOAT_EQ(static_cast<float>(colour.best_threshold), 0.3f);
  EXPECT_NEAR(colour.best.f1(), 6.0 / 7.0, 1e-9);
  EXPECT_EQ(e.tests.size(), 5u);  // no probability in these
  EXPECT_FALSE(e.has_probability);
}

TEST(DetectionEvaluation, LandmarksOnlyOfWhatWasLookedAt) {
  const std::vector<simulation::TruthObject> truth{{Label::kTree, 0, 0, 0.1, ""},
                                                   {Label::kTree, 2, 0, 0.1, ""},
                                                   {Label::kTree, 4, 0, 0.1, ""},
                                                   {Label::kObject, 6, 0, 0.1, ""}};
  std::vector<mapping::Landmark> map(3);
  map[0].label = Label::kTree;
  map[0].probability = 0.9;
  map[1].x_m = 6.0;
  map[1].label = Label::kTree;
  map[1].probability = 0.6;
  map[2].x_m = 20.0;  // stands for nothing
  map[2].label = Label::kObject;
  map[2].probability = 0.1;
  const auto result = evaluate_landmarks(map, truth, {true, true, false, true}, 0.3);
  EXPECT_EQ(result.counts.num_right, 1);
  EXPECT_EQ(result.counts.num_missed, 1);  // the third was never looked at
  EXPECT_EQ(result.counts.num_wrong, 1);
  EXPECT_EQ(result.reliability.num, 3);
  EXPECT_NEAR(result.reliability.expected_calibration_error, (0.1 + 0.6 + 0.1) / 3.0, 1e-12);
}

TEST(DetectionReport, SaysWhatWasCounted) {
  Scene scene;
  for (Detection& d : scene.messages[0].trunks) d.probability_tree = 0.7f;
  const auto observations = pair_observations(scene.messages, scene.truth, 0).pairs;
  const DetectionEvaluation e = evaluate_detections(observations, {"a<b"}, {});
  const auto json = nlohmann::json::parse(detection_json(e));
  EXPECT_DOUBLE_EQ(json["observations"]["precision"].get<double>(), 0.6);
  ASSERT_EQ(json["tests"].size(), 6u);
  EXPECT_EQ(json["tests"][0]["recall_precision"].size(), e.tests[0].curve.size());
}

TEST(WindowEvaluation, CountsAndAreasOfAHandfulOfWindows) {
  const std::vector<ScoredWindow> windows{{0, true, 0.9, 0.2, 0.5},
                                          {0, false, 0.1, 0.3, 0.5},
                                          {1, true, 0.4, 0.1, 0.5},
                                          {1, false, 0.6, 0.4, 0.5}};
  const WindowEvaluation e = evaluate_windows(windows, 0.5);
  EXPECT_EQ(e.num_trunk, 2);
  EXPECT_EQ(e.num_other, 2);
  EXPECT_EQ(e.num_groups, 2);
  EXPECT_DOUBLE_EQ(e.appearance.area, 0.75);
  EXPECT_DOUBLE_EQ(e.hue_interval.area, 0.0);
  EXPECT_DOUBLE_EQ(e.paper_hue_interval.area, 0.5);
  EXPECT_DOUBLE_EQ(e.found_fraction, 0.5);
  EXPECT_DOUBLE_EQ(e.false_fraction, 0.5);
  // Draws are of whole groups: (0,0) gives 1, (1,1) gives 0, a mixed one 0.75.
  EXPECT_DOUBLE_EQ(e.appearance.low, 0.0);
  EXPECT_DOUBLE_EQ(e.appearance.high, 1.0);
}

TEST(WindowEvaluation, JsonHoldsTheFiguresByName) {
  WindowEvaluation e = evaluate_windows({{0, true, 2, 1, 0}, {0, false, 1, 2, 0}}, 0.5);
  e.num_pictures = 1;
  const auto json = nlohmann::json::parse(window_json(e));
  EXPECT_EQ(json["auc"], 1.0);
  EXPECT_EQ(json["auc_hue_interval"], 0.0);
  EXPECT_EQ(json["auc_hue_interval_paper"], 0.5);
  EXPECT_EQ(json["pictures"], 1);
}

TEST(WindowEvaluation, OfNothingIsChance) {
  EXPECT_DOUBLE_EQ(evaluate_windows({}, 0.5).appearance.area, 0.5);
}

TEST(WindowEvaluation, AnExposureActsOnLinearLight) {
  const vision::PixelBlock pixels{{0, 0, 1, 1}, {188, 0, 255}};
  EXPECT_EQ(exposed(pixels, 0.0).bgr, pixels.bgr);
  const auto half = exposed(pixels, -1.0).bgr;
  EXPECT_NEAR(half[0], 137, 1);  // sRGB: 188 is half the light of 255, 137 half of that
  EXPECT_NEAR(half[2], 188, 1);
  EXPECT_EQ(half[1], 0);
}

}  // namespace

}  // namespace orchard::evaluation
