// SPDX-License-Identifier: BSD-3-Clause
// The detector with `colour_model: appearance`.
#include <gtest/gtest.h>

#include "detection/detect.hpp"
#include "detection/trunk_view.hpp"
#include "laser/segment.hpp"
#include "unit/detection/tube_rig.hpp"
#include "vision/appearance/appearance.hpp"
#include "vision/decode.hpp"

namespace orchard::detection {
namespace {

using test::blue_tube;
using test::brown_tube;
using test::Tube;

/// Trunks are what is redder than its surroundings.
DetectorConfig redness() {
  DetectorConfig config;
  config.colour_model = ColourModel::kAppearance;
  config.appearance.mean.assign(vision::kNumAppearanceFeatures, 0.0);
  config.appearance.scale.assign(vision::kNumAppearanceFeatures, 1.0);
  config.appearance.weights.assign(vision::kNumAppearanceFeatures, 0.0);
  config.appearance.weights[1] = 20.0;  // red_contrast
  return config;
}

Detections observe(const std::vector<Tube>& tubes, const Rig& rig) {
  const vision::Image image = test::picture_of_tubes(tubes, rig);
  return detect(test::scan_of(tubes), &image, rig).detections;
}

TEST(AppearanceModel, ItsConfidenceIsRocColourAndGatesTheEdges) {
  const Rig rig = test::tube_rig(redness());
  const auto brown = observe({brown_tube(1.5, 0.3)}, rig).trunks.at(0);
  EXPECT_EQ(brown.label, Label::kTree);
  EXPECT_GT(brown.roc_colour, 0.95f);
  EXPECT_GT(brown.roc_edges, 0.5f);
  const auto blue = observe({blue_tube(1.5, 0.3)}, rig).trunks.at(0);
  EXPECT_EQ(blue.label, Label::kObject);
  EXPECT_LT(blue.roc_colour, 0.05f);
  EXPECT_EQ(blue.roc_edges, 0.0f);
}

TEST(AppearanceModel, NeighboursInTheSameScanChangeNothing) {
  const Rig rig = test::tube_rig(redness());
  const std::vector<Tube> both{brown_tube(1.5, 0.4), blue_tube(1.2, -0.3)};
  const vision::Image image = test::picture_of_tubes(both, rig);
  for (const Detection& d : observe(both, rig).trunks) {
    const bool is_brown = d.bearing_rad > 0.0;
    const Tube tube = is_brown ? both[0] : both[1];
    // The same picture, but only one of the two in the scan: less of it is decoded.
    const auto alone = detect(test::scan_of({tube}), &image, rig).detections.trunks.at(0);
    EXPECT_EQ(alone.roc_colour, d.roc_colour);
    EXPECT_EQ(alone.label, d.label);
  }
}

TEST(AppearanceModel, RocColourIsTheConfidenceOfTheWindowBetweenTheEdges) {
  const Rig rig = test::tube_rig(redness());
  const std::vector<Tube> tubes{brown_tube(1.5, 0.3)};
  const vision::Image image = test::picture_of_tubes(tubes, rig);
  const auto segments =
      laser::segment(test::scan_of(tubes), rig.detector.segmentation, rig.detector.width);
  ASSERT_EQ(segments.size(), 1u);
  const auto view = view_of(segments[0], rig);
  ASSERT_TRUE(view.has_value());
  const vision::PixelRect window = trunk_window(*view, rig);
  EXPECT_NEAR(window.x_px, view->left_x_px, 1.0);
  EXPECT_NEAR(window.x_px + window.width_px - 1, view->right_x_px, 1.0);
  EXPECT_TRUE(
      reading_area(*view, rig).contains(vision::appearance_reading_area(window, picture_of(rig))));
  const auto pixels = vision::decode(image, picture_of(rig));
  ASSERT_TRUE(pixels.has_value());
  const double confidence = vision::appearance_confidence(
      vision::appearance_features(*pixels, window), rig.detector.appearance);
  EXPECT_NEAR(observe(tubes, rig).trunks.at(0).roc_colour, confidence, 1e-6);
}

}  // namespace
}  // namespace orchard::detection
