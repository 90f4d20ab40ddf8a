// SPDX-License-Identifier: BSD-3-Clause
// The laser's half of the detector: what becomes a candidate, an object, or stays untold.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "detection/detect.hpp"
#include "unit/detection/tube_rig.hpp"

namespace orchard::detection {
namespace {

using test::brown_tube;
using test::scan_of;
using test::Tube;
using test::tube_rig;

TEST(FindByLaser, NothingOfAnEmptyOrBrokenScan) {
  const Rig rig = tube_rig();
  EXPECT_TRUE(find_by_laser(laser::Scan{}, rig).detections.trunks.empty());
  laser::Scan scan = scan_of({brown_tube(1.5, 0.0)});
  scan.bearing_step_rad = 0.0;
  EXPECT_TRUE(find_by_laser(scan, rig).detections.trunks.empty());
  scan.bearing_step_rad = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(find_by_laser(scan, rig).detections.trunks.empty());
  EXPECT_EQ(find_by_laser(scan, rig).detections.utime, scan.utime);
}

TEST(FindByLaser, CandidatesPointAtTheirDetections) {
  const Rig rig = tube_rig();
  const auto findings = find_by_laser(
      scan_of({brown_tube(1.5, -0.6), brown_tube(1.5, 0.0, 0.20), brown_tube(1.5, 0.6)}), rig);
  ASSERT_EQ(findings.detections.trunks.size(), 3u);
  ASSERT_EQ(findings.candidates.size(), 2u);
  for (const Candidate& candidate : findings.candidates) {
    const Detection& d = findings.detections.trunks.at(candidate.index);
    EXPECT_EQ(d.range_m, candidate.segment.range_m);
    EXPECT_EQ(d.bearing_rad, candidate.segment.bearing_rad);
    EXPECT_EQ(d.label, Label::kUnseen);
  }
  EXPECT_EQ(findings.detections.trunks[1].label, Label::kObject);
}

TEST(FindByLaser, TheLaserThresholdParts) {
  Rig rig = tube_rig();
  const auto scan = scan_of({brown_tube(1.5, 0.0, 0.11)});
  rig.detector.width.mean_m = 0.15;
  rig.detector.width.sd_m = 0.03;
  const auto near = find_by_laser(scan, rig);
  EXPECT_EQ(near.candidates.size(), 1u);
  EXPECT_GT(near.detections.trunks.at(0).roc_laser, DetectorConfig::kRocLaserMin);
  rig.detector.width.sd_m = 0.01;  // the same tube is more than three of these away
  const auto beyond = find_by_laser(scan, rig);
  EXPECT_TRUE(beyond.candidates.empty());
  EXPECT_LT(beyond.detections.trunks.at(0).roc_laser, DetectorConfig::kRocLaserMin);
  EXPECT_EQ(beyond.detections.trunks.at(0).label, Label::kObject);
}

TEST(FindByLaser, AHiddenSideIsUntoldUntilWhatShowsIsTooWide) {
  for (const bool has_camera : {true, false}) {
    const Rig rig = tube_rig({}, has_camera);
    // the nearer tube hides the right part of the farther one
    for (const double width_m : {0.09, 0.40}) {
      const Tube hidden = brown_tube(2.0, 0.05 + 0.5 * width_m, width_m);
      const auto trunks =
          find_by_laser(scan_of({brown_tube(1.0, 0.0), hidden}), rig).detections.trunks;
      const Detection* behind = nullptr;
      for (const Detection& d : trunks) {
        if (d.range_m > 1.5) behind = &d;
      }
      ASSERT_NE(behind, nullptr);
      EXPECT_EQ(behind->occlusion, kOccludedRight);
      EXPECT_EQ(behind->label, width_m < 0.2 ? Label::kUnseen : Label::kObject);
    }
  }
}

TEST(FindByLaser, AHalfHiddenTrunkLiesWhereItIsNotWhereItShows) {
  const Rig rig = tube_rig();
  const Tube hidden = brown_tube(1.2, 0.07, 0.09);
  const auto trunks =
      find_by_laser(scan_of({brown_tube(0.6, -0.005, 0.07), hidden}), rig).detections.trunks;
  const Detection* behind = nullptr;
  for (const Detection& d : trunks) {
    if (d.range_m > 0.9) behind = &d;
  }
  ASSERT_NE(behind, nullptr);
  EXPECT_NE(behind->occlusion, 0);
  EXPECT_NEAR(behind->centre_x_m, hidden.x_m, 0.010);
  EXPECT_NEAR(behind->centre_y_m, hidden.y_m, 0.010);
  // and says how well that is known: far better than half a trunk
  EXPECT_LT(std::sqrt(behind->covariance[2]), 0.02);
}

TEST(FindByLaser, MostOfACircleIsEnoughWhereTheRigSaysSo) {
  for (const double visible_fraction_min : {0.5, 0.99, 1.0}) {
    DetectorConfig config;
    config.visible_fraction_min = visible_fraction_min;
    // some three quarters of the farther tube show
    const auto scan = scan_of({brown_tube(0.6, -0.005, 0.07), brown_tube(1.2, 0.07, 0.09)});
    const auto found = find_by_laser(scan, tube_rig(config));
    const bool is_judged = std::any_of(found.candidates.begin(), found.candidates.end(),
                                       [](const Candidate& c) { return c.segment.range_m > 0.9; });
    EXPECT_EQ(is_judged, visible_fraction_min == 0.5) << visible_fraction_min;
  }
}

// A few beams of an arc tell its width badly: what shows is held against a trunk's width, and a
// width that is badly known may be a trunk's.
TEST(FindByLaser, WhatShowsIsHeldAgainstATrunk) {
  const auto judged = [](double y_m, double width_m) {
    DetectorConfig config;
    config.visible_fraction_min = 0.7;
    const auto scan = scan_of({brown_tube(0.6, -0.005, 0.07), brown_tube(2.4, y_m, width_m)});
    const auto found = find_by_laser(scan, tube_rig(config));
    int num_hidden = 0;
    for (const Detection& d : found.detections.trunks) num_hidden += d.occlusion != 0 ? 1 : 0;
    EXPECT_EQ(num_hidden, 1) << y_m;
    return std::any_of(found.candidates.begin(), found.candidates.end(),
                       [](const Candidate& c) { return c.segment.range_m > 2.0; });
  };
  EXPECT_TRUE(judged(0.150, 0.09));   // some 85 %, in five beams
  EXPECT_FALSE(judged(0.120, 0.09));  // half
  EXPECT_FALSE(judged(0.25, 0.30));   // twice a trunk's width shows
}

TEST(FindByLaser, ReflectorsMarkTreesOrWhatIsNone) {
  auto scan = scan_of({brown_tube(1.5, -0.5), brown_tube(1.5, 0.5)});
  scan.intensities.assign(scan.ranges_m.size(), 100.0f);
  // the left one wears a reflector
  for (std::size_t i = 341; i < scan.ranges_m.size(); ++i) scan.intensities[i] = 900.0f;
  for (const bool has_camera : {true, false}) {
    detection::DetectorConfig config;
    config.segmentation.reflectivity_min = 500.0;
    const Label passed = has_camera ? Label::kUnseen : Label::kTree;

    auto found = find_by_laser(scan, tube_rig(config, has_camera));
    EXPECT_EQ(found.detections.trunks.at(0).label, passed);
    EXPECT_EQ(found.detections.trunks.at(1).label, passed);
    EXPECT_FLOAT_EQ(found.detections.trunks.at(0).intensity, 100.0f);
    EXPECT_FLOAT_EQ(found.detections.trunks.at(1).intensity, 900.0f);

    config.segmentation.reflector = laser::ReflectorUse::kOnly;
    found = find_by_laser(scan, tube_rig(config, has_camera));
    EXPECT_EQ(found.detections.trunks.at(0).label, Label::kObject);
    EXPECT_EQ(found.detections.trunks.at(1).label, passed);
    EXPECT_FALSE(found.intensities_missing);

    config.segmentation.reflector = laser::ReflectorUse::kExclude;
    found = find_by_laser(scan, tube_rig(config, has_camera));
    EXPECT_EQ(found.detections.trunks.at(0).label, passed);
    EXPECT_EQ(found.detections.trunks.at(1).label, Label::kObject);
    EXPECT_EQ(found.candidates.size(), has_camera ? 1u : 0u);
  }
}

TEST(FindByLaser, TwoBrightBeamsBesideANearerObjectMayBeAMixedPixel) {
  // A beam half on the tube and half on a reflector behind it reads between them, and blooms.
  for (const int num_bright : {2, 3}) {
    auto scan = scan_of({brown_tube(1.5, 0.0)});
    scan.intensities.assign(scan.ranges_m.size(), 100.0f);
    std::size_t last = 0;
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
      if (scan.ranges_m[i] > 0.0f && scan.ranges_m[i] < 2.0f) last = i;
    }
    for (int k = 1; k <= num_bright; ++k) {
      scan.ranges_m[last + static_cast<std::size_t>(k)] = 2.2f;
      scan.intensities[last + static_cast<std::size_t>(k)] = 900.0f;
    }
    detection::DetectorConfig config;
    config.segmentation.reflectivity_min = 500.0;
    config.segmentation.reflector = laser::ReflectorUse::kOnly;
    const auto found = find_by_laser(scan, tube_rig(config, false)).detections.trunks;
    const auto bright = std::find_if(found.begin(), found.end(),
                                     [](const Detection& d) { return d.intensity > 500.0f; });
    ASSERT_NE(bright, found.end());
    EXPECT_NE(bright->occlusion, 0);
    EXPECT_EQ(bright->label, num_bright == 2 ? Label::kUnseen : Label::kTree) << num_bright;
  }
}

TEST(FindByLaser, ReflectorsWithoutIntensitiesTellNothingAndThatIsSaid) {
  detection::DetectorConfig config;
  config.segmentation.reflectivity_min = 500.0;
  const auto scan = scan_of({brown_tube(1.5, 0.0)});
  EXPECT_FALSE(find_by_laser(scan, tube_rig(config)).intensities_missing);
  for (const auto use : {laser::ReflectorUse::kOnly, laser::ReflectorUse::kExclude}) {
    config.segmentation.reflector = use;
    for (const bool has_camera : {true, false}) {
      const Rig rig = tube_rig(config, has_camera);
      const auto found = find_by_laser(scan, rig);
      EXPECT_TRUE(found.intensities_missing);
      EXPECT_TRUE(found.candidates.empty());
      EXPECT_EQ(found.detections.trunks.at(0).label, Label::kUnseen);
      EXPECT_TRUE(detect(scan, nullptr, rig).intensities_missing);
    }
  }
}

}  // namespace
}  // namespace orchard::detection
