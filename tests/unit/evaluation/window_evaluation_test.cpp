// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/windows/window_evaluation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "experiments/windows/disturbance.hpp"

namespace orchard::evaluation {
namespace {

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
  e.left_out = {"a: why"};
  const auto json = nlohmann::json::parse(window_json(e));
  EXPECT_EQ(json["auc"], 1.0);
  EXPECT_EQ(json["auc_hue_interval"], 0.0);
  EXPECT_EQ(json["auc_hue_interval_paper"], 0.5);
  EXPECT_EQ(json["pictures"], 1);
  EXPECT_EQ(json["left_out"][0], "a: why");
}

TEST(WindowEvaluation, OfNothingIsChance) {
  EXPECT_DOUBLE_EQ(evaluate_windows({}, 0.5).appearance.area, 0.5);
}

TEST(Disturbance, GainsActOnLinearLight) {
  const vision::PixelBlock pixels{{0, 0, 3, 1}, {188, 0, 255, 100, 100, 100, 20, 20, 20}};
  EXPECT_EQ(disturbed(pixels, {}).bgr, pixels.bgr);
  Disturbance half;
  half.exposure_ev = -1.0;
  EXPECT_NEAR(disturbed(pixels, half).bgr[0], 137, 1);  // sRGB: 188 is half the light of 255,
  EXPECT_NEAR(disturbed(pixels, half).bgr[2], 188, 1);  // 137 half of that
  EXPECT_EQ(disturbed(pixels, half).bgr[1], 0);
  Disturbance red;
  red.red_gain = 0.5;
  EXPECT_EQ(disturbed(pixels, red).bgr[3], 100);
  EXPECT_LT(disturbed(pixels, red).bgr[5], 80);
}

}  // namespace
}  // namespace orchard::evaluation
