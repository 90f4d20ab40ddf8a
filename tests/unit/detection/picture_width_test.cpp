// SPDX-License-Identifier: BSD-3-Clause
#include "detection/picture_width.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <cmath>
#include <cstdint>
#include <random>

#include "detection/detect.hpp"
#include "unit/detection/tube_rig.hpp"

namespace orchard::detection {
namespace {

constexpr double kRange_m = 0.6;
constexpr double kWidth_m = 0.07;
constexpr double kAngleSd_rad = 0.008;

double uniform(std::mt19937_64& engine) { return static_cast<double>(engine() >> 11) * 0x1.0p-53; }

Rig sharp_rig(int times = 4) {
  geometry::CameraConfig camera;
  auto& lens = camera.intrinsics;
  lens.width_px *= times;
  lens.height_px *= times;
  for (const std::size_t i : {0u, 1u}) {
    lens.fc_px[i] *= times;
    lens.cc_px[i] *= times;
  }
  return {{}, camera, {}};
}

/// A trunk straight ahead whose angle the laser takes for `wider_rad` larger than it is.
laser::Segment trunk(double wider_rad) {
  const double half_rad = std::asin(0.5 * kWidth_m / (kRange_m + 0.5 * kWidth_m));
  laser::Segment s;
  s.range_m = s.start_range_m = s.end_range_m = kRange_m;
  s.num_beams = 20;
  s.start_bearing_rad = -half_rad - 0.5 * wider_rad;
  s.end_bearing_rad = half_rad + 0.5 * wider_rad;
  const double sine = std::sin(half_rad + 0.5 * wider_rad);
  s.width_m = 2.0 * kRange_m * sine / (1.0 - sine);
  return s;
}

/// The edges of a picture: patches of random grey on the trunk, which leans by `lean_rad`, and
/// beside it; `inside` and `outside` are how much they differ.
vision::EdgeMap edges_of(const TrunkView& view, const Rig& rig, int inside, int outside,
                         double lean_rad, std::mt19937_64& engine) {
  constexpr int kPatch_px = 5;
  const auto exact = *sides_of(trunk(0.0), rig);
  vision::PixelBlock block{windows_area(view, rig), {}};
  const int across = block.area.width_px / kPatch_px + 1;
  std::vector<int> patches(
      static_cast<std::size_t>(across * (block.area.height_px / kPatch_px + 1)));
  for (int& patch : patches) patch = static_cast<int>(100.0 * (uniform(engine) - 0.5));
  for (int y = 0; y < block.area.height_px; ++y) {
    const double aside_px = std::tan(lean_rad) * (block.area.y_px + y - exact.row_px);
    for (int x = 0; x < block.area.width_px; ++x) {
      const double x_px = block.area.x_px + x - aside_px;
      const bool on_trunk = x_px > exact.left_x_px && x_px < exact.right_x_px;
      const int patch = patches[static_cast<std::size_t>(y / kPatch_px * across + x / kPatch_px)];
      const auto grey =
          static_cast<std::uint8_t>(128 + patch * (on_trunk ? inside : outside) / 100);
      block.bgr.insert(block.bgr.end(), 3, grey);
    }
  }
  return vision::edge_map(block, rig.detector.edges);
}

std::optional<PictureWidth> measured(double wider_rad, int inside, int outside,
                                     std::mt19937_64& engine, double lean_rad = 0.0) {
  const Rig rig = sharp_rig();
  const laser::Segment segment = trunk(wider_rad);
  const auto view = view_of(segment, rig);
  return picture_width(edges_of(*view, rig, inside, outside, lean_rad, engine), *view, segment,
                       kAngleSd_rad, rig);
}

TEST(PictureWidth, ClearSidesCorrectTheLasersAngle) {
  std::mt19937_64 engine(7);
  double laser_m2 = 0.0, fused_m2 = 0.0, bias_m = 0.0;
  constexpr int kTrunks = 60;
  for (int i = 0; i < kTrunks; ++i) {
    const double wider_rad = kAngleSd_rad * 3.4 * (uniform(engine) - 0.5);  // of this sd
    const auto width = measured(wider_rad, 0, 200, engine);
    ASSERT_TRUE(width);
    EXPECT_LT(width->fused.sd_m, 0.7 * width->laser.sd_m);
    EXPECT_NEAR(width->fused.width_m, kWidth_m, 4.0 * width->fused.sd_m);
    laser_m2 += std::pow(width->laser.width_m - kWidth_m, 2);
    fused_m2 += std::pow(width->fused.width_m - kWidth_m, 2);
    bias_m += (width->fused.width_m - kWidth_m) / kTrunks;
  }
  EXPECT_LT(std::sqrt(fused_m2 / kTrunks), 0.4 * std::sqrt(laser_m2 / kTrunks));
  EXPECT_NEAR(bias_m, 0.0, 0.01 * kWidth_m);
}

// Twigs before a smooth sky: what counts is that both differ.
TEST(PictureWidth, ARoughTrunkBeforeASmoothBackgroundIsMeasuredAsWell) {
  std::mt19937_64 engine(8);
  const auto width = measured(kAngleSd_rad, 200, 0, engine);
  ASSERT_TRUE(width);
  EXPECT_NEAR(width->fused.width_m, kWidth_m, 0.03 * kWidth_m);
  EXPECT_GT(width->laser.width_m, 1.06 * kWidth_m);
}

TEST(PictureWidth, WithoutEdgesTheLaserIsBelieved) {
  std::mt19937_64 engine(9);
  const auto width = measured(kAngleSd_rad, 0, 0, engine);
  ASSERT_TRUE(width);
  EXPECT_NEAR(width->fused.width_m, width->laser.width_m, 0.1 * width->laser.sd_m);
  EXPECT_NEAR(width->fused.sd_m, width->laser.sd_m, 0.1 * width->laser.sd_m);
  EXPECT_GT(width->picture.sd_m, 1.2 * width->laser.sd_m);
}

TEST(PictureWidth, ALeaningTrunkIsMeasuredAcrossItsAxis) {
  std::mt19937_64 engine(10);
  constexpr double kLean_rad = 0.25;
  const auto width = measured(0.0, 0, 200, engine, kLean_rad);
  ASSERT_TRUE(width);
  EXPECT_NEAR(width->tilt_rad, kLean_rad, 0.05);
  EXPECT_NEAR(width->fused.width_m, kWidth_m * std::cos(kLean_rad), 0.025 * kWidth_m);
}

TEST(PictureWidth, HalfHiddenTrunksAndFineLasersAreLeftAlone) {
  std::mt19937_64 engine(11);
  const Rig rig = sharp_rig();
  laser::Segment segment = trunk(0.0);
  const auto view = view_of(segment, rig);
  const auto map = edges_of(*view, rig, 0, 200, 0.0, engine);
  EXPECT_TRUE(picture_width(map, *view, segment, kAngleSd_rad, rig));
  const double pixel_rad = 1.0 / rig.camera.intrinsics().fc_px[0];
  EXPECT_FALSE(picture_width(map, *view, segment, 1.3 * pixel_rad, rig));
  segment.occluded_left = true;
  EXPECT_FALSE(picture_width(map, *view, segment, kAngleSd_rad, rig));
}

/// R_level_base of a robot that pitches and rolls.
Eigen::Matrix3d tilted_by(double pitch_rad, double roll_rad) {
  return (Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

/// What takes level points to the plane of a scanner turned by R_level_laser: x and y of a point of
/// that plane are those of the level point that has no third coordinate in it.
Eigen::Matrix2d plane_of_level(const Eigen::Matrix3d& R_level_laser) {
  return R_level_laser.topLeftCorner<2, 2>().inverse();
}

/// RMS of the errors of widths of trunks of 0.09 m, by laser and picture of a robot that rolls.
double width_error_m(double roll_rad) {
  const Rig rig = sharp_rig();
  const Eigen::Matrix3d R_level_laser = tilted_by(0.0, roll_rad);
  double sum_m2 = 0.0;
  int num = 0;
  for (double y_m = -0.4; y_m < 0.4; y_m += 0.017, ++num) {
    const std::vector<test::Tube> tubes{test::brown_tube(1.5, y_m)};
    const vision::Image image = test::picture_of_tubes(tubes, rig, 1'000'000, R_level_laser);
    laser::Scan scan = test::scan_of(tubes);
    scan.plane_of_level = plane_of_level(R_level_laser);
    const auto found = detect(scan, &image, rig).detections.trunks.at(0);
    sum_m2 += std::pow(found.width_m - 0.09, 2);
  }
  return std::sqrt(sum_m2 / num);
}

TEST(Detect, ARolledPictureGivesWidthsToo) {
  const double level_m = width_error_m(0.0);
  EXPECT_LT(level_m, 0.0026);
  EXPECT_LT(width_error_m(0.087), 1.3 * level_m);  // 5 degrees
  EXPECT_LT(width_error_m(0.245), 1.7 * level_m);  // 14 degrees: across a slope of 25 %
}

// The trunk as it stands in the rolled picture, at the row of the scan: its sides are those
// columns.
TEST(Detect, WindowsFollowTheRoll) {
  const Rig rig = sharp_rig();
  const Eigen::Matrix3d R_level_laser = tilted_by(0.0, 0.245);
  const std::vector<test::Tube> tubes{test::brown_tube(1.5, -0.55)};
  const vision::Image image = test::picture_of_tubes(tubes, rig, 1'000'000, R_level_laser);
  const auto segment = find_by_laser(test::scan_of(tubes), rig).candidates.at(0).segment;
  const auto off_px = [&](const ScanToPicture& to_picture) {
    const auto view = view_of(segment, rig, to_picture).value();
    int first = -1, last = -1;
    for (int x = 0; x < image.width_px; ++x) {
      const auto at = static_cast<std::size_t>(std::lround(view.row_px) * image.width_px + x);
      if (image.data[3 * at] != test::kBrown[0]) continue;
      first = first < 0 ? x : first;
      last = x;
    }
    return 0.5 * (view.left_x_px + view.right_x_px) - 0.5 * (first + last);
  };
  ScanToPicture rolled;
  rolled.plane_of_level = plane_of_level(R_level_laser);
  EXPECT_GT(std::abs(off_px({})), 8.0);
  EXPECT_LT(std::abs(off_px(rolled)), 4.0);
}

// The laser's 0.35 degrees are 6 px of this camera and 1.5 px of the usual one.
TEST(Detect, ASharpPictureMakesWidthsBetterAndAnotherLeavesThem) {
  const Rig sharp = sharp_rig(), usual = sharp_rig(1);
  double laser_m2 = 0.0, fused_m2 = 0.0;
  for (double y_m = -0.4; y_m < 0.4; y_m += 0.017) {
    const std::vector<test::Tube> tubes{test::brown_tube(1.5, y_m)};
    const auto found = [&](const Rig& rig) {
      const vision::Image image = test::picture_of_tubes(tubes, rig);
      return detect(test::scan_of(tubes), &image, rig).detections.trunks.at(0);
    };
    const auto by_laser = find_by_laser(test::scan_of(tubes), sharp).detections.trunks.at(0);
    const Detection fused = found(sharp);
    EXPECT_EQ(found(usual).width_m, by_laser.width_m);
    EXPECT_EQ(fused.label, Label::kTree);
    EXPECT_NEAR(fused.width_m, 0.09, 4.0 * fused.width_sd_m);
    laser_m2 += std::pow(by_laser.width_m - 0.09, 2);
    fused_m2 += std::pow(fused.width_m - 0.09, 2);
  }
  EXPECT_LT(fused_m2, 0.5 * laser_m2);
}

}  // namespace
}  // namespace orchard::detection
