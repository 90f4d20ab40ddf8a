// SPDX-License-Identifier: BSD-3-Clause
// `orchard calibrate laser-camera`, as people run it.
#include <gmock/gmock.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "bus/messages/codec.hpp"
#include "geometry/angles.hpp"
#include "geometry/camera_model.hpp"
#include "io/config/config.hpp"
#include "io/log/log_writer.hpp"
#include "system/calibration/run_orchard.hpp"

namespace {

namespace fs = std::filesystem;
using namespace orchard;
using ::testing::HasSubstr;

class CalibrateLaserCamera : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("orchard_laser_camera_" + std::to_string(getpid()));
    fs::create_directories(folder_);
    true_rig_ = text_of(ORCHARD_SOURCE_DIR "/config/tubes.yaml");
    // what the user believes: the camera square under the laser
    std::string rig = true_rig_;
    replace(rig, "delta_m: [0.004, -0.060, -0.012]", "delta_m: [0.0, -0.05, 0.0]");
    replace(rig, "phi_rad: [1.5788, 0.0065, 1.5628]", "phi_rad: [1.5708, 0.0, 1.5708]");
    rig_text_ = rig;
    std::ofstream(path("rig.yaml")) << rig;
  }
  void TearDown() override { fs::remove_all(folder_); }

  static void replace(std::string& text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// A log of the true rig; `from` -> `to` changes it.
  std::string simulate(const std::string& board_keys, int num_poses = 12,
                       const std::string& from = {}, const std::string& to = {}) const {
    std::string rig = true_rig_;
    replace(rig, "\nsimulation:\n",
            "\nsimulation:\n  board:\n    num_poses: " + std::to_string(num_poses) +
                "\n    hold_s: 0.25\n    move_s: 0.05\n" + board_keys);
    if (!from.empty()) replace(rig, from, to);
    std::ofstream(path("true.yaml")) << rig;
    const Outcome outcome = run("simulate --scene board --seed 5 --config " + path("true.yaml") +
                                " --out " + path("board.lcm"));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    return path("board.lcm");
  }
  Outcome calibrate(const std::string& log, const std::string& more = {}) const {
    return run("calibrate laser-camera " + log + " --config " + path("rig.yaml") +
               " --columns 7 --rows 5 --square-m 0.08 --board-width-m 0.72 --board-height-m 0.56 " +
               "--out " + path("out.yaml") + " " + more);
  }
  void expect_refused(const Outcome& outcome, const std::string& reason) const {
    EXPECT_EQ(outcome.exit_code, 3) << outcome.output;
    EXPECT_THAT(outcome.output, HasSubstr(reason));
    EXPECT_FALSE(fs::exists(path("out.yaml")));
    EXPECT_EQ(text_of(path("rig.yaml")), rig_text_);
  }

  fs::path folder_;
  std::string true_rig_, rig_text_;
};

TEST_F(CalibrateLaserCamera, FindsTheMountFromPixelsAndScansTheSameEveryTime) {
  const std::string log = simulate("", 16);
  const Outcome outcome = calibrate(log);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  const auto camera = io::load_config(path("out.yaml")).camera;
  const std::array<double, 3> delta{0.004, -0.060, -0.012}, phi{1.5788, 0.0065, 1.5628};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(camera.extrinsics.delta_m[i], delta[i], 0.010) << outcome.output;
    EXPECT_NEAR(camera.extrinsics.phi_rad[i], phi[i], 0.008) << outcome.output;
  }
  const std::string first = text_of(path("out.yaml"));
  EXPECT_THAT(first, HasSubstr("# orchard calibrate laser-camera: "));
  EXPECT_EQ(text_of(path("rig.yaml")), rig_text_);
  EXPECT_EQ(calibrate(log).output, outcome.output);
  EXPECT_EQ(text_of(path("out.yaml")), first);
}

TEST_F(CalibrateLaserCamera, ABoardSeenByTheLaserOnlyIsRefused) {
  expect_refused(calibrate(simulate("    seen_by: laser_only\n", 6)), "the board was not found");
}

TEST_F(CalibrateLaserCamera, ABoardSeenByTheCameraOnlyIsRefused) {
  const Outcome outcome = calibrate(simulate("    seen_by: camera_only\n", 8));
  expect_refused(outcome, "scanner");
}

TEST_F(CalibrateLaserCamera, PicturesMirroredLeftToRightAreRefusedUnlessTheMountIsSaidToBeSo) {
  const std::string log = simulate("    flip: left_right\n");
  expect_refused(calibrate(log), "mirrored left to right");
  EXPECT_EQ(calibrate(log, "--any-mount").exit_code, 0);
}

TEST_F(CalibrateLaserCamera, PicturesMirroredTopToBottomAreRefused) {
  expect_refused(calibrate(simulate("    flip: top_bottom\n")), "mirrored top to bottom");
}

TEST_F(CalibrateLaserCamera, ACameraMountedOnItsSideIsRefused) {
  const auto camera = io::load_config(path("rig.yaml")).camera;
  const geometry::LaserToCamera straight(camera.extrinsics);
  const Eigen::AngleAxisd roll(0.5 * geometry::kPi, Eigen::Vector3d::UnitZ());
  const auto phi = geometry::paper_angles_rad(roll.toRotationMatrix() * straight.rotation());
  std::ostringstream phi_rad;
  phi_rad << "phi_rad: [" << phi[0] << ", " << phi[1] << ", " << phi[2] << "]";
  expect_refused(calibrate(simulate("", 12, "phi_rad: [1.5788, 0.0065, 1.5628]", phi_rad.str())),
                 "the camera is rotated by 9");
}

TEST_F(CalibrateLaserCamera, DegenerateMotionIsNamed) {
  expect_refused(calibrate(simulate("    handling: turned_only\n", 10)), "about one axis only");
}

TEST_F(CalibrateLaserCamera, AnEmptyLogIsRefused) {
  std::ofstream(path("empty.lcm")).flush();
  expect_refused(calibrate(path("empty.lcm")), "empty.lcm: ");
}

class OtherPictures : public CalibrateLaserCamera {
 protected:
  /// A log of a scan and of pictures of these widths, at 4:3.
  std::string log_of(const std::vector<int>& widths_px) const {
    io::LogWriter writer(path("pictures.lcm"));
    laser::Scan scan;
    scan.utime = 1000000;
    scan.bearing_step_rad = 0.006;
    scan.range_max_m = 5.6;
    scan.ranges_m.assign(100, 2.0f);
    writer.write(scan.utime, bus::info(bus::Channel::kScan).name, bus::encode(scan));
    vision::Image image;
    image.encoding = vision::Encoding::kGray8;
    for (const int width_px : widths_px) {
      image.utime = scan.utime + 1000 * (1 + image.seq++);
      image.width_px = width_px;
      image.height_px = 3 * width_px / 4;
      image.data.assign(static_cast<std::size_t>(image.width_px * image.height_px), 128);
      writer.write(image.utime, bus::info(bus::Channel::kImage).name, bus::encode(image));
    }
    writer.close();
    return path("pictures.lcm");
  }
};

TEST_F(OtherPictures, OfDifferentSizesAreRefused) {
  expect_refused(calibrate(log_of({320, 640, 320})), "the pictures differ in size: 1 of 3");
}

TEST_F(OtherPictures, OfAnotherCameraAreRefused) {
  expect_refused(calibrate(log_of({640, 640})), "give the configuration of this camera");
}

TEST_F(CalibrateLaserCamera, ImportsTheToolbox) {
  std::ofstream(path("toolbox.txt")) << "Delta = [0.01 -0.05 0.02] m\nPhi = [0.5 -1 -179] deg\n";
  const Outcome outcome = run("calibrate laser-camera --import " + path("toolbox.txt") +
                              " --config " + path("rig.yaml") + " --out " + path("out.yaml"));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_NEAR(io::load_config(path("out.yaml")).camera.extrinsics.delta_m[1], -0.05, 1e-9);
}

}  // namespace
