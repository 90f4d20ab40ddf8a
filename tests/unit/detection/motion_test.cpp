// SPDX-License-Identifier: BSD-3-Clause
#include "detection/motion.hpp"

#include <gtest/gtest.h>

#include "detection/detect.hpp"
#include "detection/scan_image_pairer.hpp"
#include "detection/trunk_view.hpp"
#include "unit/detection/tube_rig.hpp"

namespace orchard::detection {
namespace {

TEST(Motion, StraightAheadBringsThingsNearer) {
  const PlanePoint p = after_motion({2.0, 0.5}, {0, 1.5, 0.0}, 0.1);
  EXPECT_NEAR(p.x_m, 1.85, 1e-12);
  EXPECT_NEAR(p.y_m, 0.5, 1e-12);
}

TEST(Motion, TurningLeftMovesThingsRight) {
  const PlanePoint p = after_motion({2.0, 0.0}, {0, 0.0, 0.5}, 0.2);
  EXPECT_NEAR(p.x_m, 2.0 * std::cos(0.1), 1e-12);
  EXPECT_NEAR(p.y_m, -2.0 * std::sin(0.1), 1e-12);
}

TEST(Motion, ManySmallStepsMakeTheSameArc) {
  const Motion motion{0, 1.2, 0.8};
  PlanePoint p{1.5, -0.4};
  for (int i = 0; i < 1000; ++i) p = after_motion(p, motion, 0.001);
  const PlanePoint once = after_motion({1.5, -0.4}, motion, 1.0);
  EXPECT_NEAR(p.x_m, once.x_m, 1e-9);
  EXPECT_NEAR(p.y_m, once.y_m, 1e-9);
  const PlanePoint back = after_motion(once, motion, -1.0);
  EXPECT_NEAR(back.x_m, 1.5, 1e-12);
  EXPECT_NEAR(back.y_m, -0.4, 1e-12);
}

TEST(Motion, DetectionsFollowTheRobotFromTheBeamToThePicture) {
  laser::LaserConfig mount;
  mount.mount_x_m = 0.3;
  const Rig rig = test::tube_rig({}, true, mount);
  const auto scan = test::scan_of({test::brown_tube(1.6, 0.3)});
  const Motion motion{0, 1.5, 1.0};
  for (const double dt_s : {0.05, 0.1, -0.1}) {
    // Where the laser would see the tube that long after the beam that saw it.
    PlanePoint later = after_motion({1.9, 0.3}, motion, dt_s);
    const auto beam_utime = detect(scan, nullptr, rig).detections.trunks.at(0).utime;
    const auto image = test::picture_of_tubes({test::brown_tube(later.x_m - 0.3, later.y_m)}, rig,
                                              beam_utime + static_cast<std::int64_t>(1e6 * dt_s));
    const Detection without = detect(scan, &image, rig).detections.trunks.at(0);
    const Detection with = detect(scan, &image, rig, motion).detections.trunks.at(0);
    EXPECT_GT(with.roc_colour, 0.95f);
    EXPECT_GT(with.roc_edges, 0.8f);
    EXPECT_LT(without.roc_colour, with.roc_colour - 0.1f);
  }
}

TEST(Motion, EachSideOfAnObjectMovesFromItsOwnBeam) {
  // A slow scanner, so that the robot turns while it passes one trunk.
  const Rig rig = test::tube_rig();
  auto scan = test::scan_of({test::brown_tube(1.5, 0.0)});
  scan.beam_period_us = 2000.0;
  const auto segment = laser::segment(scan, rig.detector.segmentation, rig.detector.width).at(0);
  const double yaw_rate_radps = 0.5;
  const double first_dt_s = 0.75;
  const ScanToPicture motion{{0, 0.0, yaw_rate_radps}, first_dt_s, 2e-3};
  const auto moved = view_of(segment, rig, motion);
  ASSERT_TRUE(moved.has_value());
  const auto column = [&](double bearing_rad, double beam) {
    const double turned_rad = yaw_rate_radps * (first_dt_s - 2e-3 * beam);
    const auto& camera = rig.camera.intrinsics();
    return camera.cc_px[0] - camera.fc_px[0] * std::tan(bearing_rad - turned_rad);
  };
  EXPECT_NEAR(moved->right_x_px,
              column(segment.start_bearing_rad, static_cast<double>(segment.first_beam)), 1e-6);
  EXPECT_NEAR(moved->left_x_px,
              column(segment.end_bearing_rad, static_cast<double>(segment.last_beam)), 1e-6);
}

TEST(Motion, ThePictureCountsAtItsExposure) {
  geometry::CameraConfig camera;
  camera.delay_s = 0.05;
  const Rig rig({}, camera, {});
  LaserFindings findings;
  findings.detections.utime = 1'000'000;
  findings.beam_period_s = 1e-4;
  vision::Image image;
  image.utime = 1'080'000;
  EXPECT_FALSE(to_picture(findings, image, rig, std::nullopt).has_value());
  const auto motion = to_picture(findings, image, rig, Motion{0, 1.0, 0.0});
  ASSERT_TRUE(motion.has_value());
  EXPECT_NEAR(motion->dt_s(0.0), 0.03, 1e-12);
  EXPECT_NEAR(motion->dt_s(500.0), -0.02, 1e-12);
}

TEST(Motion, PairsWaitForTheMotionAtThePicture) {
  ScanImagePairer pairer(0.06, 0.25, true);
  laser::Scan scan;
  scan.utime = 1'000'000;
  vision::Image image;
  image.utime = 1'030'000;
  EXPECT_TRUE(pairer.add(scan).empty());
  EXPECT_TRUE(pairer.add(image).empty());
  EXPECT_TRUE(pairer.add(Motion{1'020'000, 1.0, 0.0}).empty());
  const auto pairs = pairer.add(Motion{1'045'000, 2.0, 0.0});
  ASSERT_EQ(pairs.size(), 1u);
  ASSERT_TRUE(pairs[0].motion.has_value());
  EXPECT_EQ(pairs[0].motion->speed_mps, 2.0);  // the mean since the one before
}

TEST(Motion, PairsDoNotWaitForMotionsForEver) {
  ScanImagePairer pairer(0.06, 0.25, true);
  laser::Scan scan;
  scan.utime = 1'000'000;
  vision::Image image;
  image.utime = 1'000'000;
  pairer.add(scan);
  EXPECT_TRUE(pairer.add(image).empty());
  image.utime = 1'300'000;
  const auto pairs = pairer.add(image);
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].image->utime, 1'000'000);
  EXPECT_FALSE(pairs[0].motion.has_value());
  EXPECT_EQ(pairer.num_late(), 0);
}

}  // namespace
}  // namespace orchard::detection
