// SPDX-License-Identifier: BSD-3-Clause
// The detector with `colour_model: appearance`.
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "detection/detect.hpp"
#include "detection/detection.hpp"
#include "detection/trunk_view.hpp"
#include "geometry/angles.hpp"
#include "laser/segment.hpp"
#include "unit/detection/tube_rig.hpp"
#include "vision/appearance.hpp"
#include "vision/decode.hpp"

namespace orchard::detection {
namespace {

using test::blue_tube;
using test::brown_tube;
using test::picture_of_tubes;
using test::scan_of;
using test::Tube;
using test::tube_rig;

/// The detection nearest to a place in base.
const Detection& at(const Detections& detections, double x_m, double y_m) {
  const Detection* best = nullptr;
  double best_m = 0.1;
  for (const Detection& d : detections.trunks) {
    const double distance_m = std::hypot(d.centre_x_m - x_m, d.centre_y_m - y_m);
    if (distance_m < best_m) {
      best_m = distance_m;
      best = &d;
    }
  }
  static const Detection kNone;
  EXPECT_NE(best, nullptr) << "nothing at " << x_m << " " << y_m;
  return best ? *best : kNone;
}

Detections observe(const std::vector<Tube>& tubes, const Rig& rig) {
  const vision::Image image = picture_of_tubes(tubes, rig);
  const DetectResult result = detect(scan_of(tubes), &image, rig);
  EXPECT_FALSE(result.image_unusable);
  return result.detections;
}

TEST(Detect, ATubeOfTheRightWidthAndColourIsATree) {
  const Rig rig = tube_rig();
  const Detections found = observe({brown_tube(1.5, 0.3)}, rig);
  ASSERT_EQ(found.trunks.size(), 1u);
  const Detection& d = found.trunks[0];
  EXPECT_EQ(d.label, Label::kTree);
  EXPECT_NEAR(d.width_m, 0.09, 0.012);
  EXPECT_NEAR(d.centre_x_m, 1.5, 0.01);
  EXPECT_NEAR(d.centre_y_m, 0.3, 0.01);
  EXPECT_GT(d.roc_laser, 0.5f);
  EXPECT_GT(d.roc_colour, 0.95f);
  EXPECT_GT(d.roc_left_edge, 0.8f);
  EXPECT_GT(d.roc_right_edge, 0.8f);
  EXPECT_GT(d.roc_parallel, 0.8f);
  EXPECT_NEAR(d.roc_edges, fuse_edges(d.roc_left_edge, d.roc_right_edge, d.roc_parallel), 1e-6);
  EXPECT_NEAR(d.roc_vision, fuse_vision(d.roc_colour, d.roc_edges, 0.6), 1e-6);
  EXPECT_NEAR(d.roc_tree, fuse_tree(d.roc_laser, d.roc_vision, 0.5), 1e-6);
  EXPECT_EQ(found.image_utime, 1'000'000);
}

TEST(Detect, AnotherColourIsAnObjectWhoseEdgesNobodyObservationsAt) {
  const Rig rig = tube_rig();
  const Detections found = observe({blue_tube(1.5, 0.3)}, rig);
  const Detection& d = at(found, 1.5, 0.3);
  EXPECT_EQ(d.label, Label::kObject);
  EXPECT_GT(d.roc_laser, 0.5f);
  EXPECT_EQ(d.roc_colour, 0.0f);
  EXPECT_EQ(d.roc_edges, 0.0f);
  EXPECT_EQ(d.roc_vision, 0.0f);
  EXPECT_NEAR(d.roc_tree, 0.5 * d.roc_laser, 1e-6);
}

TEST(Detect, AnotherWidthIsAnObjectEvenOutOfTheCamerasView) {
  const Rig rig = tube_rig();
  const Detections found = observe({brown_tube(1.5, 0.3, 0.17), brown_tube(0.0, 1.5, 0.17)}, rig);
  for (const auto& [x_m, y_m] : {std::pair{1.5, 0.3}, std::pair{0.0, 1.5}}) {
    const Detection& d = at(found, x_m, y_m);
    EXPECT_EQ(d.label, Label::kObject);
    EXPECT_LT(d.roc_tree, 0.01f);
    EXPECT_EQ(d.roc_vision, 0.0f);
  }
}

TEST(Detect, ACandidateTheCameraDoesNotSeeIsUnseen) {
  const Rig rig = tube_rig();
  const Detections beside = observe({brown_tube(0.0, 1.5)}, rig);
  EXPECT_EQ(at(beside, 0.0, 1.5).label, Label::kUnseen);
  EXPECT_EQ(at(beside, 0.0, 1.5).roc_tree, 0.0f);
  const auto without = detect(scan_of({brown_tube(1.5, 0.3)}), nullptr, rig);
  EXPECT_FALSE(without.image_unusable);
  EXPECT_EQ(without.detections.image_utime, 0);
  EXPECT_EQ(at(without.detections, 1.5, 0.3).label, Label::kUnseen);
}

// Its side is known to a beam step, some two pixels of this rig: at the very border of the picture
// it may seem to lie beyond.
TEST(Detect, ATubeThatEndsAtThePicturesBorderIsLookedAt) {
  const auto label_where_its_side_is = [](double beyond_px, double principal_px) {
    geometry::CameraConfig camera;
    camera.enabled = true;
    camera.intrinsics.cc_px[0] = principal_px;
    const Rig rig{{}, camera, {}};
    const double column_px = camera.intrinsics.width_px - 1 + beyond_px;
    const double side_rad = -std::atan((column_px - principal_px) / camera.intrinsics.fc_px[0]);
    const double middle_rad = side_rad + std::asin(0.045 / 1.5);
    const Tube tube = brown_tube(1.5 * std::cos(middle_rad), 1.5 * std::sin(middle_rad));
    return at(observe({tube}, rig), tube.x_m, tube.y_m).label;
  };
  for (double principal_px = 158.0; principal_px < 162.0; principal_px += 0.3) {
    EXPECT_EQ(label_where_its_side_is(0.0, principal_px), Label::kTree) << principal_px;
    EXPECT_EQ(label_where_its_side_is(4.0, principal_px), Label::kUnseen) << principal_px;
  }
}

TEST(Detect, ATreeHalfHiddenByAnotherIsNotTakenForAnObject) {
  const Rig rig = tube_rig();
  const std::vector<Tube> tubes{brown_tube(1.0, 0.0), brown_tube(2.0, 0.11)};
  const Detections found = observe(tubes, rig);
  EXPECT_EQ(at(found, 1.0, 0.0).label, Label::kTree);
  for (const Detection& d : found.trunks) {
    if (d.range_m < 1.5) continue;
    EXPECT_EQ(d.label, Label::kUnseen);
    EXPECT_NE(d.occlusion, 0);
  }
}

TEST(Detect, WithoutACameraTheLaserDecides) {
  const Rig rig = tube_rig({}, false);
  const auto result =
      detect(scan_of({brown_tube(1.5, 0.3), brown_tube(0.0, 1.5, 0.17)}), nullptr, rig);
  const Detection& tree = at(result.detections, 1.5, 0.3);
  EXPECT_EQ(tree.label, Label::kTree);
  EXPECT_EQ(tree.roc_tree, tree.roc_laser);
  EXPECT_EQ(at(result.detections, 0.0, 1.5).label, Label::kObject);
}

TEST(Detect, AnUnusablePictureIsSaidAndNothingIsMadeOfIt) {
  const Rig rig = tube_rig();
  vision::Image image = picture_of_tubes({brown_tube(1.5, 0.3)}, rig);
  image.encoding = vision::Encoding::kJpeg;  // which the bytes are not
  auto result = detect(scan_of({brown_tube(1.5, 0.3)}), &image, rig);
  EXPECT_TRUE(result.image_unusable);
  EXPECT_EQ(at(result.detections, 1.5, 0.3).label, Label::kUnseen);
  image.encoding = vision::Encoding::kBgr8;
  image.width_px = 240;
  image.height_px = 320;
  EXPECT_TRUE(detect(scan_of({brown_tube(1.5, 0.3)}), &image, rig).image_unusable);
}

TEST(Detect, TheLaserMountIsComposedInFull) {
  laser::LaserConfig mount;
  mount.mount_x_m = 0.25;
  mount.mount_y_m = -0.1;
  mount.mount_yaw_rad = 0.3;
  const Rig rig = tube_rig({}, true, mount);
  const std::vector<Tube> tubes{brown_tube(1.5, 0.3)};
  const Detections found = observe(tubes, rig);
  const double x_m = 0.25 + 1.5 * std::cos(0.3) - 0.3 * std::sin(0.3);
  const double y_m = -0.1 + 1.5 * std::sin(0.3) + 0.3 * std::cos(0.3);
  EXPECT_NEAR(at(found, x_m, y_m).centre_x_m, x_m, 0.01);
  EXPECT_NEAR(at(found, x_m, y_m).centre_y_m, y_m, 0.01);
}

TEST(Detect, EachDetectionHasTheTimeOfItsMiddleBeam) {
  const Rig rig = tube_rig();
  const auto scan = scan_of({brown_tube(1.5, 0.3)});
  const auto result = detect(scan, nullptr, rig);
  const double beam = (std::atan2(0.3, 1.5) - scan.bearing_min_rad) / scan.bearing_step_rad;
  EXPECT_NEAR(static_cast<double>(result.detections.trunks[0].utime),
              1e6 + beam * scan.beam_period_us, 1.0 * scan.beam_period_us);
}

TEST(Detect, TheCovarianceIsThatOfRangeAndBearing) {
  const Rig rig = tube_rig();
  const Detection ahead = observe({brown_tube(2.0, 0.0)}, rig).trunks.at(0);
  EXPECT_GT(ahead.covariance[0], 0.0);
  EXPECT_GT(ahead.covariance[2], 0.0);
  EXPECT_NEAR(ahead.covariance[1], 0.0, 0.02 * ahead.covariance[0]);
  const Detection beside = observe({brown_tube(0.0, 2.0)}, rig).trunks.at(0);
  EXPECT_NEAR(beside.covariance[0], ahead.covariance[2], 0.05 * ahead.covariance[2]);
  EXPECT_NEAR(beside.covariance[2], ahead.covariance[0], 0.05 * ahead.covariance[0]);
}

TEST(Detect, AJpegGivesWhatOpenCvsDecodingOfItGives) {
  const Rig rig = tube_rig();
  const std::vector<Tube> tubes{brown_tube(1.1, 0.5), brown_tube(1.5, 0.3), brown_tube(2.0, -0.1),
                                blue_tube(1.3, -0.4), brown_tube(2.5, -0.9)};
  vision::Image raw = picture_of_tubes(tubes, rig);
  cv::Mat picture(raw.height_px, raw.width_px, CV_8UC3, raw.data.data());
  cv::Mat noise(picture.size(), picture.type());
  cv::theRNG().state = 7;
  cv::randn(noise, cv::Scalar::all(0), cv::Scalar::all(6));
  picture += noise;
  vision::Image jpeg = raw;
  jpeg.encoding = vision::Encoding::kJpeg;
  cv::imencode(".jpg", picture, jpeg.data, {cv::IMWRITE_JPEG_QUALITY, 85});
  const cv::Mat decoded = cv::imdecode(jpeg.data, cv::IMREAD_COLOR);
  raw.data.assign(decoded.datastart, decoded.dataend);

  const auto scan = scan_of(tubes);
  const auto ours = detect(scan, &jpeg, rig).detections.trunks;
  const auto plain = detect(scan, &raw, rig).detections.trunks;
  ASSERT_EQ(ours.size(), plain.size());
  int seen = 0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    EXPECT_EQ(ours[i].roc_colour, plain[i].roc_colour);
    EXPECT_EQ(ours[i].roc_left_edge, plain[i].roc_left_edge);
    EXPECT_EQ(ours[i].roc_right_edge, plain[i].roc_right_edge);
    EXPECT_EQ(ours[i].roc_parallel, plain[i].roc_parallel);
    EXPECT_EQ(ours[i].roc_tree, plain[i].roc_tree);
    EXPECT_EQ(ours[i].label, plain[i].label);
    if (ours[i].label != Label::kUnseen) ++seen;
  }
  EXPECT_GE(seen, 4);
}

TEST(Detect, NothingToSeeGivesNothing) {
  const Rig rig = tube_rig();
  EXPECT_TRUE(detect(scan_of({}), nullptr, rig).detections.trunks.empty());
  EXPECT_TRUE(detect(laser::Scan{}, nullptr, rig).detections.trunks.empty());
}

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

TEST(Centre, ThePapersEquationsAreASpecialCase) {
  // Eqs. 11, 12: no heading, no lever arm, to the bark. The paper's X is right, its Y forward.
  const Rig rig = test::tube_rig();
  laser::Segment segment;
  segment.range_m = 2.0;
  segment.bearing_rad = 0.4;
  segment.num_beams = 8;
  Detection d;
  place_in_base(d, segment, test::scan_of({}), false, rig);
  const double beta_rad = geometry::paper_bearing_rad(segment.bearing_rad);
  EXPECT_NEAR(-d.surface_y_m, 2.0 * std::sin(beta_rad), 1e-12);
  EXPECT_NEAR(d.surface_x_m, 2.0 * std::cos(beta_rad), 1e-12);
}

TEST(Centre, LiesHalfAWidthBehindTheBark) {
  const Rig rig = test::tube_rig();
  laser::Segment segment;
  segment.range_m = 2.0;
  segment.width_m = 0.2;
  segment.num_beams = 8;
  Detection d;
  place_in_base(d, segment, test::scan_of({}), false, rig);
  EXPECT_NEAR(d.centre_x_m, 2.1, 1e-12);
}

TEST(Centre, ATrunksRadiusLeansOnTheModel) {
  const Rig rig = test::tube_rig();  // 90 mm, sd 10 mm
  laser::Segment segment;
  segment.range_m = 2.0;
  segment.width_m = 0.11;
  segment.width_sd_m = 0.01;
  segment.num_beams = 8;
  Detection d;
  place_in_base(d, segment, test::scan_of({}), true, rig);
  EXPECT_NEAR(d.centre_x_m, 2.0 + 0.05, 1e-9);  // half way between 90 and 110 mm
  segment.width_sd_m = 1e-3;
  place_in_base(d, segment, test::scan_of({}), true, rig);
  EXPECT_NEAR(d.centre_x_m, 2.0 + 0.055, 2e-4);
}

TEST(Centre, AHiddenSideMakesTheBearingUncertain) {
  const Rig rig = test::tube_rig();
  laser::Segment segment;
  segment.range_m = 2.0;
  segment.width_m = 0.05;
  segment.num_beams = 4;
  Detection clear, hidden;
  hidden.occlusion = kOccludedLeft;
  place_in_base(clear, segment, test::scan_of({}), true, rig);
  place_in_base(hidden, segment, test::scan_of({}), true, rig);
  EXPECT_GT(hidden.covariance[2], clear.covariance[2] + 0.04 * 0.04);
  EXPECT_NEAR(hidden.covariance[0], clear.covariance[0], 1e-12);
}

TEST(Fuse, GivesThePapersOutdoorAverages) {
  EXPECT_NEAR(fuse_vision(0.9, 0.705, 0.6), 0.822, 1e-12);  // section 6.2
}

TEST(Fuse, ExplainsThePapersObjectB2) {
  // Table 2: 0.461 with colour failed, so that its roc_laser was 0.922.
  EXPECT_NEAR(fuse_tree(0.922, 0.0, 0.5), 0.461, 1e-12);
  EXPECT_EQ(label_of(0.461, 0.6), Label::kObject);
  EXPECT_EQ(label_of(0.786, 0.6), Label::kTree);  // T11, the least of table 1
}

TEST(Fuse, EdgesAreTheMeanOfThree) {
  EXPECT_NEAR(fuse_edges(0.9, 0.6, 0.3), 0.6, 1e-12);
  EXPECT_DOUBLE_EQ(fuse_edges(1.0, 1.0, 1.0), 1.0);
}

TEST(Fuse, TheThresholdItselfIsATree) { EXPECT_EQ(label_of(0.6, 0.6), Label::kTree); }

}  // namespace
}  // namespace orchard::detection
