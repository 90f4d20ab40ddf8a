// SPDX-License-Identifier: BSD-3-Clause
#include "detection/camera_check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "geometry/angles.hpp"
#include "unit/detection/tube_rig.hpp"

namespace orchard::detection {
namespace {

using geometry::kPi;
using test::Tube;

DetectorConfig detector_with_motion() {
  DetectorConfig detector;
  detector.use_odometry = true;
  return detector;
}

/// The rig of tube_rig() with a camera turned about its own axes (x right, y down, z ahead).
Rig turned_rig(int axis, double angle_rad, double focal = 1.0, double delay_s = 0.0) {
  geometry::CameraConfig camera;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  const int i = (axis + 1) % 3, k = (axis + 2) % 3;
  turn(i, i) = turn(k, k) = std::cos(angle_rad);
  turn(k, i) = std::sin(angle_rad);
  turn(i, k) = -turn(k, i);
  camera.extrinsics.phi_rad =
      geometry::paper_angles_rad(turn * geometry::LaserToCamera(camera.extrinsics).rotation());
  for (double& fc_px : camera.intrinsics.fc_px) fc_px *= focal;
  camera.delay_s = delay_s;
  return {{}, camera, detector_with_motion()};
}

/// Takes pictures of places among tubes by the true rig's camera while the robot turns.
void look(CameraCheck& check, const Rig& stated, const Rig& truth, int num_pictures) {
  constexpr double turn_radps = 0.3;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> bearing(-0.45, 0.45), range(1.0, 3.0);
  for (int place = 0, num = 0; num < num_pictures; ++place) {
    std::vector<Tube> tubes;
    for (int i = 0; i < 4; ++i) {
      const double b = -0.5 + 0.28 * i + 0.25 * bearing(random), r = range(random);
      tubes.push_back(test::brown_tube(r * std::cos(b), r * std::sin(b)));
    }
    // The scan is taken at one instant, and the picture with it; the turn tells a delay.
    laser::Scan scan = test::scan_of(tubes);
    scan.beam_period_us = 0.0;
    const vision::Image image = test::picture_of_tubes(tubes, truth);
    vision::PictureReader picture(image);
    const Motion motion{scan.utime, 0.0, place / 2 % 2 == 0 ? turn_radps : -0.7 * turn_radps};
    if (auto sight = camera_sight(find_by_laser(scan, stated), picture, stated, motion)) {
      check.add(*std::move(sight));
      ++num;
    }
  }
}

/// What `stated` makes of thirty pictures.
std::vector<Finding> findings_of(const Rig& stated) {
  CameraCheck check(stated);
  look(check, stated, test::tube_rig(detector_with_motion()), 30);
  check.finish();
  return check.findings();
}

std::string names(const std::vector<Finding>& findings) {
  std::string names;
  for (const Finding& finding : findings) names += (names.empty() ? "" : " ") + finding.name;
  return names;
}

double radians(double angle_deg) { return angle_deg * kPi / 180.0; }

TEST(CameraCheck, ARightCameraIsNotDoubted) {
  EXPECT_EQ(names(findings_of(test::tube_rig(detector_with_motion()))), "");
  EXPECT_EQ(names(findings_of(turned_rig(1, radians(1.0)))), "");
}

TEST(CameraCheck, NamesHowTheCameraIsTurned) {
  const auto yaw = findings_of(turned_rig(1, radians(5.0)));
  ASSERT_EQ(names(yaw), "camera_yaw");
  EXPECT_EQ(yaw[0].key, "camera.phi_rad");
  EXPECT_EQ(names(findings_of(turned_rig(1, radians(-6.0)))), "camera_yaw");
  const auto roll = findings_of(turned_rig(2, radians(5.0)));
  ASSERT_EQ(names(roll), "camera_roll");
  EXPECT_NE(roll[0].text.find("lean by 5 degrees"), std::string::npos) << roll[0].text;
  EXPECT_EQ(names(findings_of(turned_rig(2, radians(180.0)))), "camera_flipped");
}

TEST(CameraCheck, TellsAPitchByWhereItLooks) {
  // The rig says that the camera looks down by 6 degrees; it looks level, so further up.
  const auto down = findings_of(turned_rig(0, radians(6.0)));
  ASSERT_EQ(names(down), "camera_pitch");
  const auto up = findings_of(turned_rig(0, radians(-6.0)));
  ASSERT_EQ(names(up), "camera_pitch");
  const bool first_up = down[0].text.find("further up") != std::string::npos;
  const bool second_up = up[0].text.find("further up") != std::string::npos;
  EXPECT_NE(first_up, second_up);
  // By the rig's own rotation: what is ahead of the laser lies above the picture's middle (negative
  // y) for a camera that looks down.
  const Eigen::Vector3d ahead = turned_rig(0, radians(6.0)).T_camera_laser.rotation().col(0);
  EXPECT_EQ(first_up, ahead.y() < 0.0);
}

TEST(CameraCheck, NamesLensAndDelayWithTheValueThatFits) {
  const auto lens = findings_of(turned_rig(1, 0.0, 2.0));
  ASSERT_EQ(names(lens), "camera_focal");
  EXPECT_EQ(lens[0].key, "camera.fc_px");
  const auto delay = findings_of(turned_rig(1, 0.0, 1.0, 0.2));
  ASSERT_EQ(names(delay), "camera_delay");
  EXPECT_NE(delay[0].text.find("camera.delay_s is 0.20, but the pictures fit "), std::string::npos);
}

TEST(CameraCheck, ACameraThatIsKnockedIsNamedAndClearsOnceItIsRight) {
  const Rig stated = test::tube_rig(detector_with_motion());
  // A camera turned by 5 degrees: all columns shift by f tan(5 degrees).
  geometry::CameraConfig camera;
  camera.intrinsics.cc_px[0] += camera.intrinsics.fc_px[0] * std::tan(radians(5.0));
  const Rig knocked{{}, camera, detector_with_motion()};
  CameraCheck check(stated);
  look(check, stated, stated, 60);
  EXPECT_EQ(names(check.findings()), "");
  look(check, stated, knocked, 60);
  EXPECT_EQ(names(check.findings()), "camera_yaw");
  look(check, stated, stated, 60);
  EXPECT_EQ(names(check.findings()), "");  // of the last minute
  check.finish();
  EXPECT_EQ(names(check.findings()), "camera_yaw");  // of the run
}

TEST(LookTimes, TakesOnePictureASecond) {
  LookTimes times;
  int num_taken = 0;
  for (int i = 0; i < 100; ++i) num_taken += times.take(1'000'000 + 100'000 * i) ? 1 : 0;
  EXPECT_EQ(num_taken, 10);
}

TEST(CameraCheck, WithoutObjectsNothingIsSaid) {
  const Rig rig = test::tube_rig();
  CameraCheck check(rig);
  check.finish();
  EXPECT_TRUE(check.findings().empty());
}

}  // namespace
}  // namespace orchard::detection
