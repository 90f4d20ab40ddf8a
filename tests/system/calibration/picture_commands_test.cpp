// SPDX-License-Identifier: BSD-3-Clause
// `orchard calibrate trunks --images` and what evaluate_windows finds of it, as people run them.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "io/config/config.hpp"
#include "system/calibration/run_orchard.hpp"

namespace {

namespace fs = std::filesystem;
using namespace orchard;

/// What evaluate_windows of the experiments prints.
Outcome windows(const std::string& arguments, bool with_errors = false) {
  return run(arguments, with_errors, "experiments/evaluate_windows");
}

class PictureCommands : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("orchard_pictures_" + std::to_string(getpid()));
    fs::create_directories(folder_ / "images");
    fs::create_directories(folder_ / "masks");
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// A brown bar, as wide as `number` makes it, before grey noise.
  void write_pair(int number) const {
    cv::RNG random(static_cast<std::uint64_t>(number) + 1);
    cv::Mat picture(160, 200, CV_8UC3), mask(160, 200, CV_8UC3, cv::Scalar(0, 0, 0));
    random.fill(picture, cv::RNG::UNIFORM, 90, 150);
    const cv::Rect trunk(60 + 5 * number, 0, 16 + number, 160);
    cv::Mat bark = picture(trunk);
    bark = bark.mul(cv::Scalar(0.4, 0.6, 0.9));
    mask(trunk).setTo(cv::Scalar(0, 0, 128));
    const std::string name = std::to_string(100 + number);
    cv::imwrite((folder_ / "images" / (name + ".jpg")).string(), picture);
    cv::imwrite((folder_ / "masks" / (name + ".png")).string(), mask);
  }
  std::string folders() const {
    return " --images " + (folder_ / "images").string() + " --masks " +
           (folder_ / "masks").string() + " ";
  }
  std::string in_folder(const std::string& name) const { return (folder_ / name).string(); }

  fs::path folder_;
};

TEST_F(PictureCommands, LearnAModelAndTellHowGoodItIs) {
  for (int i = 0; i < 6; ++i) write_pair(i);
  const Outcome learnt =
      run("calibrate trunks" + folders() + "--only 100-103 --out " + in_folder("model.yaml"));
  ASSERT_EQ(learnt.exit_code, 0) << learnt.output;
  const auto model = orchard::io::load_config(in_folder("model.yaml")).detector;
  EXPECT_EQ(model.colour_model, orchard::detection::ColourModel::kAppearance);
  EXPECT_TRUE(model.appearance.learnt());
  EXPECT_NE(text_of(in_folder("model.yaml")).find("4 pictures of 4 trees"), std::string::npos);

  const Outcome told = windows(folders() + "--only 104-105 --model " +
                               in_folder("model.yaml"));
  ASSERT_EQ(told.exit_code, 0) << told.output;
  const auto json = nlohmann::json::parse(told.output);
  EXPECT_GT(json["auc"], 0.99);
  EXPECT_EQ(json["pictures"], 2);
  EXPECT_EQ(json["windows_on_trunks"], json["windows_elsewhere"]);

  // The same pictures give the same model.
  run("calibrate trunks" + folders() + "--only 100-103 --out " + in_folder("again.yaml"));
  EXPECT_EQ(text_of(in_folder("again.yaml")), text_of(in_folder("model.yaml")));
}

TEST_F(PictureCommands, TheRestOfARigStaysAsItWas) {
  for (int i = 0; i < 3; ++i) write_pair(i);
  fs::copy_file(ORCHARD_SOURCE_DIR "/config/tubes.yaml", folder_ / "rig.yaml");
  const std::string before = text_of(in_folder("rig.yaml"));
  const Outcome learnt = run("calibrate trunks" + folders() + "--config " + in_folder("rig.yaml"));
  ASSERT_EQ(learnt.exit_code, 0) << learnt.output;
  EXPECT_EQ(text_of(in_folder("rig.yaml.bak")), before);
  const auto was = orchard::io::parse_config(before, "before");
  const auto now = orchard::io::load_config(in_folder("rig.yaml"));
  EXPECT_EQ(now.detector.width.mean_m, was.detector.width.mean_m);
  EXPECT_NE(text_of(in_folder("rig.yaml")).find("# The rig of the paper's"), std::string::npos);
  // Once more, over what it wrote itself.
  EXPECT_EQ(run("calibrate trunks" + folders() + "--config " + in_folder("rig.yaml")).exit_code, 0);
}

TEST_F(PictureCommands, WhatCannotBeUsedIsNamedAndCounted) {
  for (int i = 0; i < 5; ++i) write_pair(i);
  fs::remove(folder_ / "masks" / "101.png");
  std::ofstream(folder_ / "images" / "102.jpg") << "no picture";
  const Outcome learnt = run("calibrate trunks" + folders() + "--out " + in_folder("m.yaml"));
  ASSERT_EQ(learnt.exit_code, 0) << learnt.output;
  EXPECT_NE(learnt.output.find("101: has no mask"), std::string::npos) << learnt.output;
  EXPECT_NE(learnt.output.find("102.jpg"), std::string::npos);
  const auto json =
      nlohmann::json::parse(windows(folders() + "--json --model " + in_folder("m.yaml")).output);
  EXPECT_EQ(json["left_out"].size(), 2u);
  EXPECT_EQ(json["pictures"], 3);
}

TEST_F(PictureCommands, BadInputIsOneSentenceAndExitCode3) {
  const std::string out = in_folder("m.yaml");
  const auto expect_refused = [&](const Outcome& outcome, const std::string& why) {
    EXPECT_EQ(outcome.exit_code, 3) << outcome.output;
    EXPECT_NE(outcome.output.find(why), std::string::npos) << outcome.output;
    EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
    EXPECT_FALSE(fs::exists(out));
  };
  const auto refused = [&](const std::string& arguments, const std::string& why) {
    expect_refused(run(arguments), why);
  };
  refused("calibrate trunks" + folders() + "--out " + out, "has no picture");
  write_pair(0);
  refused("calibrate trunks" + folders() + "--only 500-600 --out " + out,
          "the numbers go from 100");
  refused("calibrate trunks" + folders() + "--only x --out " + out, "must be picture numbers");
  expect_refused(windows(folders() + "--model " ORCHARD_SOURCE_DIR "/config/tubes.yaml", true),
                 "has no learnt detector.appearance");
  expect_refused(windows(folders() + "--model " + in_folder("none.yaml"), true), "cannot be read");
  cv::imwrite((folder_ / "masks" / "100.png").string(), cv::Mat(10, 10, CV_8UC3, {0, 0, 128}));
  refused("calibrate trunks" + folders() + "--out " + out,
          "a mask must have the size of its picture");
}

/// Real trunks: learnt from the first twenty pictures, judged on all others, as they are and with
/// four times the light, of which much is blown out.
TEST_F(PictureCommands, CherryTrunksAreToldFromWhatSurroundsThem) {
  const fs::path data = fs::path(ORCHARD_DATA_DIR) / "cherry_trunks";
  if (!fs::is_directory(data)) GTEST_SKIP() << data << " is not there";
  const std::string there =
      " --images " + (data / "images").string() + " --masks " + (data / "masks").string() + " ";
  const Outcome learnt =
      run("calibrate trunks" + there + "--quiet --only 000-019 --out " + in_folder("model.yaml"));
  ASSERT_EQ(learnt.exit_code, 0) << learnt.output;
  const auto judged = [&](const std::string& light) {
    const Outcome told =
        windows(there + "--only 020-119 --json --model " + in_folder("model.yaml") + light);
    EXPECT_EQ(told.exit_code, 0);
    return nlohmann::json::parse(told.output);
  };
  EXPECT_GE(judged(" --exposure 2")["auc"], 0.975);
  const auto json = judged("");
  EXPECT_EQ(json["pictures"], 99);
  EXPECT_GE(json["auc"], 0.98);
  EXPECT_LT(json["auc_hue_interval"], 0.6);
  EXPECT_LT(json["auc_hue_interval_paper"], 0.6);
}

}  // namespace
