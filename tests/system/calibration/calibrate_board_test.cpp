// SPDX-License-Identifier: BSD-3-Clause
// `orchard calibrate camera` and `orchard calibrate laser-camera`, as people run them.
#include <gmock/gmock.h>
#include <Eigen/Geometry>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "bus/messages/codec.hpp"
#include "geometry/angles.hpp"
#include "geometry/camera_model.hpp"
#include "io/config/config.hpp"
#include "io/log/log_writer.hpp"
#include "simulation/board_scene.hpp"
#include "system/calibration/calibration_fixture.hpp"
#include "worlds/board_motion.hpp"

namespace orchard {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

Outcome calibrate(const std::string& arguments) { return run("calibrate camera " + arguments); }

/// Pictures of one board by the camera of config/tubes.yaml, made once for all tests.
struct Pictures {
  geometry::CameraIntrinsics lens =
      io::load_config(ORCHARD_SOURCE_DIR "/config/tubes.yaml").camera.intrinsics;
  std::vector<calibration::GreyPicture> board;
  calibration::GreyPicture nothing;

  Pictures() {
    const calibration::BoardConfig chessboard;
    simulation::BoardPictureConfig observation;
    observation.samples_per_side = 3;
    const simulation::BoardPainter painter(lens, chessboard, observation);
    simulation::Random random(301);
    for (const auto& pose : simulation::show_board(lens, chessboard, 18, {}, random)) {
      board.push_back(painter.take(pose, random));
    }
    nothing = painter.take(std::nullopt, random);
  }
};

const Pictures& pictures() {
  static const Pictures made;
  return made;
}

void write_picture(const fs::path& path, const calibration::GreyPicture& picture) {
  const cv::Mat grey(picture.height_px, picture.width_px, CV_8UC1,
                     const_cast<std::uint8_t*>(picture.grey.data()));
  ASSERT_TRUE(cv::imwrite(path.string(), grey));
}

class CalibrateCamera : public CalibrationTest {
 protected:
  void SetUp() override {
    CalibrationTest::SetUp();
    fs::create_directories(folder_ / "board");
    rig_ = folder_ / "rig.yaml";
    fs::copy_file(ORCHARD_SOURCE_DIR "/config/orchard.yaml", rig_);
    before_ = text_of(rig_);
  }
  void write_board_pictures(std::size_t count = 1000) const {
    for (std::size_t i = 0; i < std::min(count, pictures().board.size()); ++i) {
      char name[32];
      std::snprintf(name, sizeof name, "board/%02zu.%s", i, i % 2 == 0 ? "png" : "jpg");
      write_picture(folder_ / name, pictures().board[i]);
    }
  }

  /// One clear sentence that says `words`, exit code 3, and the rig as it was.
  void expect_refusal(const std::string& arguments, const std::string& words,
                      int num_lines = 1) const {
    const Outcome outcome = calibrate(arguments + " --quiet --config " + rig_.string());
    EXPECT_EQ(outcome.exit_code, 3) << arguments << ": " << outcome.output;
    EXPECT_THAT(outcome.output, HasSubstr(words));
    EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), num_lines)
        << outcome.output;
    EXPECT_EQ(text_of(rig_), before_) << arguments;
    EXPECT_FALSE(fs::exists(rig_.string() + ".bak"));
  }

  void expect_lens(const fs::path& rig) const {
    const geometry::CameraIntrinsics found = io::load_config(rig.string()).camera.intrinsics;
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_NEAR(found.fc_px[i], pictures().lens.fc_px[i], 0.005 * pictures().lens.fc_px[i]);
      EXPECT_NEAR(found.cc_px[i], pictures().lens.cc_px[i], 1.5);
    }
    EXPECT_NEAR(found.kc[0], pictures().lens.kc[0], 0.01);
    EXPECT_EQ(found.width_px, 320);
    EXPECT_EQ(found.alpha_c, 0.0);
  }

  fs::path rig_;
  std::string before_;
};

TEST_F(CalibrateCamera, FindsTheLensThatTookThePictures) {
  write_board_pictures();
  write_picture(folder_ / "board/99.png", pictures().nothing);
  const std::string arguments = path("board") + " --config " + rig_.string();
  const Outcome outcome = calibrate(arguments + " --out " + path("out.yaml"));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  expect_lens(path("out.yaml"));
  EXPECT_EQ(text_of(rig_), before_);
  EXPECT_THAT(outcome.output, HasSubstr("all checks passed"));
  EXPECT_THAT(outcome.output, HasSubstr("no board found in 1 of"));
  EXPECT_THAT(outcome.output, HasSubstr("99.png"));
  EXPECT_THAT(text_of(path("out.yaml")), HasSubstr("# orchard calibrate camera: "));

  // the same pictures give the same bytes; in place the old file is kept
  ASSERT_EQ(calibrate(arguments).exit_code, 0);
  EXPECT_EQ(text_of(rig_), text_of(path("out.yaml")));
  EXPECT_EQ(text_of(rig_.string() + ".bak"), before_);
}

TEST_F(CalibrateCamera, ReadsALogAndMakesANewRig) {
  io::LogWriter log(path("board.lcm"));
  vision::Image image;
  image.encoding = vision::Encoding::kGray8;
  image.width_px = 320;
  image.height_px = 240;
  for (const calibration::GreyPicture& picture : pictures().board) {
    image.utime += 500'000;
    ++image.seq;
    image.data = picture.grey;
    log.write(image.utime, bus::info(bus::Channel::kImage).name, bus::encode(image));
  }
  log.close();
  const Outcome outcome = calibrate(path("board.lcm") + " --out " + path("new.yaml"));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  expect_lens(path("new.yaml"));
}

TEST_F(CalibrateCamera, ABadResultIsNotWrittenUnlessForced) {
  write_board_pictures(6);
  const std::string arguments = path("board") + " --quiet --config " + rig_.string();
  const Outcome refused = calibrate(arguments);
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.output, HasSubstr("too few views: "));
  EXPECT_THAT(refused.output, HasSubstr("was not written"));
  EXPECT_EQ(text_of(rig_), before_);
  const Outcome forced = calibrate(arguments + " --force --out " + path("forced.yaml"));
  EXPECT_EQ(forced.exit_code, 0) << forced.output;
  EXPECT_THAT(text_of(path("forced.yaml")), HasSubstr("FORCED"));
}

TEST_F(CalibrateCamera, BadPicturesAreOneSentence) {
  expect_refusal(path("missing.png"), "missing.png: cannot be read");
  expect_refusal(path("board"), "this folder has no pictures");
  write_picture(folder_ / "board/0.png", pictures().nothing);
  expect_refusal(path("board"), "no board was found in any of the 1 pictures");
  write_picture(folder_ / "board/1.png",
                {640, 240, std::vector<std::uint8_t>(std::size_t{640} * 240, 90)});
  expect_refusal(path("board"), "1.png: its size is 640 x 240 pixels, but");
  std::ofstream(path("text.png")) << std::string(5000, 'x');
  expect_refusal(path("text.png"), "text.png: is neither a JPEG nor a PNG");
  const std::string whole = text_of(folder_ / "board/0.png");
  std::ofstream(path("half.png")) << whole.substr(0, 40);
  expect_refusal(path("half.png"), "half.png: is a damaged PNG", 2);  // libpng speaks too
  std::string bomb = whole;  // the header states 65536 columns more
  bomb[17] = 1;
  std::ofstream(path("bomb.png")) << bomb;
  expect_refusal(path("bomb.png"), "bomb.png: is a damaged PNG");
  std::ofstream(path("empty.lcm")).flush();
  expect_refusal(path("empty.lcm"), "empty.lcm: this file is neither an LCM log nor a picture");
  io::LogWriter log(path("scans.lcm"));
  log.write(1, bus::info(bus::Channel::kScan).name, std::vector<std::uint8_t>(20));
  log.close();
  expect_refusal(path("scans.lcm"), "scans.lcm: this log has no IMAGE");
}

TEST_F(CalibrateCamera, AnotherCamerasRigIsRefused) {
  write_board_pictures(3);
  const std::string other = path("other.yaml");
  std::ofstream(other) << "camera:\n  width_px: 640\n  height_px: 480\n";
  const Outcome outcome = calibrate(path("board") + " --quiet --config " + other);
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.output,
              HasSubstr("other.yaml: camera.width_px x height_px is 640 x 480, but"));
  EXPECT_EQ(text_of(other), "camera:\n  width_px: 640\n  height_px: 480\n");
}

TEST_F(CalibrateCamera, ABoardThatCannotBeIsOneSentence) {
  write_board_pictures(1);
  expect_refusal(path("board") + " --columns 1", "1 x 6");
  expect_refusal(path("board") + " --square-m 30", "in metres");
  expect_refusal("", "no input: give pictures");
}

TEST_F(CalibrateCamera, ImportsTheFilesOfOtherTools) {
  std::ofstream(path("camera.yaml"))
      << "image_width: 320\nimage_height: 240\ndistortion_model: plumb_bob\n"
         "camera_matrix: {data: [221.5, 0, 161.3, 0, 221.9, 118.2, 0, 0, 1]}\n"
         "distortion_coefficients: {data: [-0.105, 0.018, 0.0006, -0.0004, 0]}\n";
  const std::string out = path("imported.yaml");
  const Outcome outcome =
      calibrate("--import " + path("camera.yaml") + " --config " + rig_.string() + " --out " + out);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  expect_lens(out);
  EXPECT_THAT(text_of(out), HasSubstr("imported from a ROS"));

  std::ofstream(path("ros.yaml"))
      << "image_width: 640\nimage_height: 480\ndistortion_model: plumb_bob\n"
         "camera_matrix: {rows: 3, cols: 3, data: [500, 0, 320, 0, 500, 240, 0, 0, 1]}\n"
         "distortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\n";
  expect_refusal("--import " + path("ros.yaml"), "give the configuration of this camera");
  expect_refusal("--import " + path("nothing.yaml"), "nothing.yaml: cannot be read");
  expect_refusal("--import " + rig_.string(), "has no image_width");
}

class CalibrateLaserCamera : public CalibrationTest {
 protected:
  void SetUp() override {
    CalibrationTest::SetUp();
    true_rig_ = text_of(ORCHARD_SOURCE_DIR "/config/tubes.yaml");
    // what the user believes: the camera square under the laser
    std::string rig = true_rig_;
    replace(rig, "delta_m: [0.004, -0.060, -0.012]", "delta_m: [0.0, -0.05, 0.0]");
    replace(rig, "phi_rad: [1.5788, 0.0065, 1.5628]", "phi_rad: [1.5708, 0.0, 1.5708]");
    rig_text_ = rig;
    std::ofstream(path("rig.yaml")) << rig;
  }
  static void replace(std::string& text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
  }
  /// A log of the true rig; `from` -> `to` changes it.
  std::string simulate(int num_poses, const std::string& from = {},
                       const std::string& to = {}) const {
    std::string rig = true_rig_;
    replace(rig, "\nsimulation:\n",
            "\nsimulation:\n  board:\n    num_poses: " + std::to_string(num_poses) +
                "\n    hold_s: 0.25\n    move_s: 0.05\n");
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

  std::string true_rig_, rig_text_;
};

TEST_F(CalibrateLaserCamera, FindsTheMountFromPixelsAndScansTheSameEveryTime) {
  const std::string log = simulate(16);
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

TEST_F(CalibrateLaserCamera, AnotherBoardThanTheOneInThePicturesIsNotFound) {
  expect_refused(run("calibrate laser-camera " + simulate(6) + " --config " + path("rig.yaml") +
                     " --columns 8 --rows 5 --square-m 0.08 --out " + path("out.yaml")),
                 "the board was not found");
}

TEST_F(CalibrateLaserCamera, ACameraMountedOnItsSideIsRefusedUnlessItIsSaidToBeSo) {
  const auto camera = io::load_config(path("rig.yaml")).camera;
  const geometry::LaserToCamera straight(camera.extrinsics);
  const Eigen::AngleAxisd roll(0.5 * geometry::kPi, Eigen::Vector3d::UnitZ());
  const auto phi = geometry::paper_angles_rad(roll.toRotationMatrix() * straight.rotation());
  std::ostringstream phi_rad;
  phi_rad << "phi_rad: [" << phi[0] << ", " << phi[1] << ", " << phi[2] << "]";
  const std::string log = simulate(12, "phi_rad: [1.5788, 0.0065, 1.5628]", phi_rad.str());
  expect_refused(calibrate(log), "the camera is rotated by 9");
  EXPECT_EQ(calibrate(log, "--any-mount").exit_code, 0);
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

}  // namespace
}  // namespace orchard
