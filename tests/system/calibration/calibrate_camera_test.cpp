// SPDX-License-Identifier: BSD-3-Clause
// `orchard calibrate camera`, as people run it.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "bus/messages/codec.hpp"
#include "io/config/config.hpp"
#include "io/log/log_writer.hpp"
#include "simulation/board_scene.hpp"
#include "system/calibration/run_orchard.hpp"
#include "worlds/board_motion.hpp"

namespace {

namespace fs = std::filesystem;
using namespace orchard;

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

class CalibrateCamera : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("orchard_camera_" + std::to_string(getpid()));
    fs::create_directories(folder_ / "board");
    rig_ = folder_ / "rig.yaml";
    fs::copy_file(ORCHARD_SOURCE_DIR "/config/orchard.yaml", rig_);
    before_ = text_of(rig_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string in_folder(const std::string& name) const { return (folder_ / name).string(); }

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
    EXPECT_NE(outcome.output.find(words), std::string::npos) << outcome.output;
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

  fs::path folder_;
  fs::path rig_;
  std::string before_;
};

TEST_F(CalibrateCamera, FindsTheLensThatTookThePictures) {
  write_board_pictures();
  write_picture(folder_ / "board/99.png", pictures().nothing);
  const std::string arguments =
      in_folder("board") + " --config " + rig_.string() + " --coverage " + in_folder("seen.png");
  const Outcome outcome = calibrate(arguments + " --out " + in_folder("out.yaml"));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  expect_lens(in_folder("out.yaml"));
  EXPECT_EQ(text_of(rig_), before_);
  EXPECT_NE(outcome.output.find("all checks passed"), std::string::npos) << outcome.output;
  EXPECT_NE(outcome.output.find("no board found in 1 of"), std::string::npos) << outcome.output;
  EXPECT_NE(outcome.output.find("99.png"), std::string::npos) << outcome.output;
  EXPECT_NE(text_of(in_folder("out.yaml")).find("# orchard calibrate camera: "), std::string::npos);
  EXPECT_GT(fs::file_size(in_folder("seen.png")), 5000u);

  // the same pictures give the same bytes; in place the old file is kept
  ASSERT_EQ(calibrate(arguments).exit_code, 0);
  EXPECT_EQ(text_of(rig_), text_of(in_folder("out.yaml")));
  EXPECT_EQ(text_of(rig_.string() + ".bak"), before_);
}

TEST_F(CalibrateCamera, ReadsALogAndMakesANewRig) {
  io::LogWriter log(in_folder("board.lcm"));
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
  const Outcome outcome = calibrate(in_folder("board.lcm") + " --out " + in_folder("new.yaml"));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  expect_lens(in_folder("new.yaml"));
}

TEST_F(CalibrateCamera, ABadResultIsNotWrittenUnlessForced) {
  write_board_pictures(6);
  const std::string arguments = in_folder("board") + " --quiet --config " + rig_.string();
  const Outcome refused = calibrate(arguments);
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_NE(refused.output.find("too few views: "), std::string::npos) << refused.output;
  EXPECT_NE(refused.output.find("was not written"), std::string::npos) << refused.output;
  EXPECT_EQ(text_of(rig_), before_);
  const Outcome forced = calibrate(arguments + " --force --out " + in_folder("forced.yaml"));
  EXPECT_EQ(forced.exit_code, 0) << forced.output;
  EXPECT_NE(text_of(in_folder("forced.yaml")).find("FORCED"), std::string::npos);
}

TEST_F(CalibrateCamera, BadPicturesAreOneSentence) {
  expect_refusal(in_folder("missing.png"), "missing.png: cannot be read");
  expect_refusal(in_folder("board"), "this folder has no pictures");
  write_picture(folder_ / "board/0.png", pictures().nothing);
  expect_refusal(in_folder("board"), "no board was found in any of the 1 pictures");
  write_picture(folder_ / "board/1.png",
                {640, 240, std::vector<std::uint8_t>(std::size_t{640} * 240, 90)});
  expect_refusal(in_folder("board"), "1.png: its size is 640 x 240 pixels, but");
  std::ofstream(in_folder("text.png")) << std::string(5000, 'x');
  expect_refusal(in_folder("text.png"), "text.png: is neither a JPEG nor a PNG");
  const std::string whole = text_of(folder_ / "board/0.png");
  std::ofstream(in_folder("half.png")) << whole.substr(0, 40);
  expect_refusal(in_folder("half.png"), "half.png: is a damaged PNG", 2);  // libpng speaks too
  std::string bomb = whole;  // the header states 65536 columns more
  bomb[17] = 1;
  std::ofstream(in_folder("bomb.png")) << bomb;
  expect_refusal(in_folder("bomb.png"), "bomb.png: is a damaged PNG");
  std::ofstream(in_folder("empty.lcm")).flush();
  expect_refusal(in_folder("empty.lcm"),
                 "empty.lcm: this file is neither an LCM log nor a picture");
  io::LogWriter log(in_folder("scans.lcm"));
  log.write(1, bus::info(bus::Channel::kScan).name, std::vector<std::uint8_t>(20));
  log.close();
  expect_refusal(in_folder("scans.lcm"), "scans.lcm: this log has no IMAGE");
}

TEST_F(CalibrateCamera, AnotherCamerasRigIsRefused) {
  write_board_pictures(3);
  const std::string other = in_folder("other.yaml");
  std::ofstream(other) << "camera:\n  width_px: 640\n  height_px: 480\n";
  const Outcome outcome = calibrate(in_folder("board") + " --quiet --config " + other);
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.output.find("other.yaml: camera.width_px x height_px is 640 x 480, but"),
            std::string::npos)
      << outcome.output;
  EXPECT_EQ(text_of(other), "camera:\n  width_px: 640\n  height_px: 480\n");
}

TEST_F(CalibrateCamera, ABoardThatCannotBeIsOneSentence) {
  write_board_pictures(1);
  expect_refusal(in_folder("board") + " --columns 1", "1 x 6");
  expect_refusal(in_folder("board") + " --square-m 30", "in metres");
  expect_refusal(in_folder("board") + " --board charuco --dictionary 9x9_9", "9x9_9");
  expect_refusal("", "no input: give pictures");
}

TEST_F(CalibrateCamera, ImportsTheFilesOfOtherTools) {
  std::ofstream(in_folder("Calib_Results.m"))
      << "%-- Focal length:\nfc = [ 221.5 ; 221.9 ];\n%-- Principal point:\ncc = [ 161.3 ; 118.2 ];"
         "\nalpha_c = 0;\nkc = [ -0.105 ; 0.018 ; 0.0006 ; -0.0004 ; 0 ];\nnx = 320;\nny = 240;\n"
         "fc_error = [ 0.3 ; 0.3 ];\n";
  const std::string out = in_folder("imported.yaml");
  const Outcome outcome = calibrate("--import " + in_folder("Calib_Results.m") + " --config " +
                                    rig_.string() + " --out " + out);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  expect_lens(out);
  EXPECT_NE(text_of(out).find("imported from Bouguet"), std::string::npos);

  std::ofstream(in_folder("ros.yaml"))
      << "image_width: 640\nimage_height: 480\ndistortion_model: plumb_bob\n"
         "camera_matrix: {rows: 3, cols: 3, data: [500, 0, 320, 0, 500, 240, 0, 0, 1]}\n"
         "distortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\n";
  expect_refusal("--import " + in_folder("ros.yaml"), "give the configuration of this camera");
  expect_refusal("--import " + in_folder("nothing.yaml"), "nothing.yaml: cannot be read");
  expect_refusal("--import " + rig_.string(), "has no image_width");
}

}  // namespace
