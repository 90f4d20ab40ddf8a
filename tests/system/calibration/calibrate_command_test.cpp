// SPDX-License-Identifier: BSD-3-Clause
// `orchard calibrate trunks`, as people run it.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "io/config/config.hpp"
#include "system/calibration/run_orchard.hpp"

namespace {

namespace fs = std::filesystem;
using namespace orchard;

class CalibrateCommand : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("orchard_calibrate_" + std::to_string(getpid()));
    fs::create_directories(folder_);
    rig_ = folder_ / "rig.yaml";
    fs::copy_file(ORCHARD_SOURCE_DIR "/config/tubes.yaml", rig_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string in_folder(const std::string& name) const { return (folder_ / name).string(); }
  std::string simulate(int seed) const {
    const std::string log = in_folder("tubes_" + std::to_string(seed) + ".lcm");
    const Outcome outcome = run("simulate --scene tubes --seed " + std::to_string(seed) +
                                " --config " + rig_.string() + " --out " + log);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    return log;
  }

  fs::path folder_;
  fs::path rig_;
};

/// The number in the line "24 trunks, 134 observations: ...".
int num_trunks(const std::string& output) {
  const std::size_t at = output.find(" trunks, ");
  if (at == std::string::npos) return 0;
  return std::atoi(output.c_str() + output.rfind('\n', at) + 1);
}

TEST_F(CalibrateCommand, WritesWhatItMeasuredIntoTheRig) {
  // A rig that believes in trunks twice as wide and of another colour.
  std::string rig = text_of(rig_);
  for (const auto& [key, value] : {std::pair<std::string, std::string>{"mean_m:", "0.2"},
                                   {"hue_min_deg:", "200"},
                                   {"hue_max_deg:", "220"}}) {
    const std::size_t at = rig.find("    " + key) + 4 + key.size();
    rig.replace(at, rig.find('\n', at) - at, " " + value);
  }
  std::ofstream(rig_) << rig;

  const std::string logs = simulate(1001) + " " + simulate(1002);
  const std::string out = in_folder("calibrated.yaml");
  const Outcome outcome =
      run("calibrate trunks " + logs + " --config " + rig_.string() + " --out " + out);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  const auto config = orchard::io::load_config(out);
  EXPECT_NEAR(config.detector.width.mean_m, 0.090, 0.003);
  EXPECT_GT(config.detector.width.sd_m, 0.002);
  EXPECT_LT(config.detector.width.sd_m, 0.012);
  EXPECT_GT(config.detector.colour.hue_min_deg, 10.0);
  EXPECT_LT(config.detector.colour.hue_max_deg, 55.0);
  // 24 stand there. In so few pictures one or two of them look like anything else.
  EXPECT_GE(num_trunks(outcome.output), 21) << outcome.output;
  EXPECT_LE(num_trunks(outcome.output), 24) << outcome.output;
  EXPECT_NE(text_of(out).find("# The rig of the paper's simulated environment"), std::string::npos);
  EXPECT_EQ(text_of(rig_), rig);  // the input stays as it was
}

TEST_F(CalibrateCommand, KeepsTheOldFileWhenItWritesInPlace) {
  const std::string before = text_of(rig_);
  const Outcome outcome = run("calibrate trunks " + simulate(1003) + " --config " + rig_.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_GE(num_trunks(outcome.output), 10) << outcome.output;
  EXPECT_LE(num_trunks(outcome.output), 12) << outcome.output;
  EXPECT_NE(outcome.output.find("trunks were found; 20 or more are needed"), std::string::npos);
  EXPECT_EQ(text_of(rig_.string() + ".bak"), before);
  EXPECT_NE(text_of(rig_), before);
}

TEST_F(CalibrateCommand, BadInputIsOneSentenceAndExitCode3) {
  std::ofstream(in_folder("empty.lcm")).flush();
  std::ofstream(in_folder("text.lcm")) << std::string(5000, 'x');
  for (const char* name : {"missing.lcm", "empty.lcm", "text.lcm"}) {
    const Outcome outcome = run("calibrate trunks " + in_folder(name) + " --config " +
                                rig_.string() + " --out " + in_folder("out.yaml"));
    EXPECT_EQ(outcome.exit_code, 3) << name << ": " << outcome.output;
    EXPECT_NE(outcome.output.find(name), std::string::npos) << outcome.output;
    EXPECT_FALSE(fs::exists(in_folder("out.yaml")));
  }
}

TEST_F(CalibrateCommand, ListsWhatItSawAndLearnsFromThosePicked) {
  const std::string log = simulate(1004);
  const std::string before = text_of(rig_);
  const Outcome listed = run("calibrate trunks " + log + " --config " + rig_.string() + " --list " +
                             in_folder("things"));
  ASSERT_EQ(listed.exit_code, 0) << listed.output;
  EXPECT_EQ(text_of(rig_), before);
  EXPECT_FALSE(fs::exists(rig_.string() + ".bak"));
  EXPECT_GT(fs::file_size(in_folder("things/thing_1.png")), 100u);
  EXPECT_NE(text_of(in_folder("things/index.html")).find("thing_1.png"), std::string::npos);
  std::istringstream csv(text_of(in_folder("things/things.csv")));
  std::string trees, line;
  int num_picked = 0;
  for (std::getline(csv, line); std::getline(csv, line);) {
    if (line.find(",trunk,") == std::string::npos || num_picked == 6) continue;
    trees += (trees.empty() ? "" : ",") + line.substr(0, line.find(','));
    ++num_picked;
  }
  ASSERT_EQ(num_picked, 6);
  const Outcome picked =
      run("calibrate trunks " + log + " --config " + rig_.string() + " --out " +
          in_folder("picked.yaml") + " --colour-model hue_interval --trees " + trees);
  ASSERT_EQ(picked.exit_code, 0) << picked.output;
  EXPECT_NE(text_of(in_folder("picked.yaml")).find("6 trunks"), std::string::npos);
  EXPECT_NE(text_of(in_folder("picked.yaml")).find("picked by number"), std::string::npos);
  const auto config = orchard::io::load_config(in_folder("picked.yaml"));
  EXPECT_NEAR(config.detector.width.mean_m, 0.090, 0.004);
  EXPECT_EQ(config.detector.colour_model, orchard::detection::ColourModel::kHueInterval);
}

TEST_F(CalibrateCommand, LearnsAppearanceAndTrunksOfAFirstMap) {
  const std::string log = simulate(1005);
  ASSERT_EQ(
      run("map " + log + " --config " + rig_.string() + " --out " + in_folder("map")).exit_code, 0);
  std::istringstream csv(text_of(in_folder("map/map.csv")));
  std::string ids, line;
  for (std::getline(csv, line); std::getline(csv, line);) {
    if (line.find(",tree,") == std::string::npos) continue;
    ids += (ids.empty() ? "" : ",") + line.substr(0, line.find(','));
  }
  const std::string command = "calibrate trunks " + log + " --config " + rig_.string() + " --map " +
                              in_folder("map") + " --out " + in_folder("out.yaml") +
                              " --colour-model appearance --ids ";
  const Outcome outcome = run(command + ids);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("area under the ROC curve"), std::string::npos);
  const auto config = orchard::io::load_config(in_folder("out.yaml"));
  EXPECT_EQ(config.detector.colour_model, orchard::detection::ColourModel::kAppearance);
  EXPECT_NEAR(config.detector.width.mean_m, 0.090, 0.004);

  fs::remove(in_folder("out.yaml"));
  for (const char* bad : {"9999", "4,x", "7-3"}) {
    const Outcome refused = run(command + bad);
    EXPECT_EQ(refused.exit_code, 3) << refused.output;
    EXPECT_NE(refused.output.find(bad[0] == '9' ? "no landmark has id 9999" : "neither a number"),
              std::string::npos)
        << refused.output;
    EXPECT_FALSE(fs::exists(in_folder("out.yaml")));
  }
}

TEST_F(CalibrateCommand, ALogWithoutPicturesIsRefused) {
  const std::string log = in_folder("blind.lcm");
  const std::string config = ORCHARD_SOURCE_DIR "/config/urg_front.yaml";
  ASSERT_EQ(run("simulate --scene tubes --seed 7 --config " + config + " --out " + log).exit_code,
            0);
  const Outcome outcome = run("calibrate trunks " + log + " --config " + rig_.string() + " --out " +
                              in_folder("out.yaml"));
  EXPECT_EQ(outcome.exit_code, 3) << outcome.output;
  EXPECT_NE(outcome.output.find("no scan with a picture"), std::string::npos) << outcome.output;
  EXPECT_FALSE(fs::exists(in_folder("out.yaml")));
}

}  // namespace
