// SPDX-License-Identifier: BSD-3-Clause
// `orchard calibrate trunks`, and the appearance learnt from pictures.
#include <gmock/gmock.h>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "io/config/config.hpp"
#include "system/calibration/calibration_fixture.hpp"

namespace orchard {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class CalibrateCommand : public CalibrationTest {
 protected:
  void SetUp() override {
    CalibrationTest::SetUp();
    rig_ = folder_ / "rig.yaml";
    fs::copy_file(ORCHARD_SOURCE_DIR "/config/tubes.yaml", rig_);
  }
  std::string simulate(int seed) const {
    const std::string log = path("tubes_" + std::to_string(seed) + ".lcm");
    const Outcome outcome = run("simulate --scene tubes --seed " + std::to_string(seed) +
                                " --config " + rig_.string() + " --out " + log);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    return log;
  }

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
  const std::string out = path("calibrated.yaml");
  const Outcome outcome =
      run("calibrate trunks " + logs + " --config " + rig_.string() + " --out " + out);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  const auto config = io::load_config(out);
  EXPECT_NEAR(config.detector.width.mean_m, 0.090, 0.003);
  EXPECT_GT(config.detector.width.sd_m, 0.002);
  EXPECT_LT(config.detector.width.sd_m, 0.012);
  EXPECT_GT(config.detector.colour.hue_min_deg, 10.0);
  EXPECT_LT(config.detector.colour.hue_max_deg, 55.0);
  // 24 stand there. In so few pictures one or two of them look like anything else.
  EXPECT_GE(num_trunks(outcome.output), 21) << outcome.output;
  EXPECT_LE(num_trunks(outcome.output), 24) << outcome.output;
  EXPECT_THAT(text_of(out), HasSubstr("# The rig of the paper's simulated environment"));
  EXPECT_EQ(text_of(rig_), rig);  // the input stays as it was
}

TEST_F(CalibrateCommand, KeepsTheOldFileWhenItWritesInPlace) {
  const std::string before = text_of(rig_);
  const Outcome outcome = run("calibrate trunks " + simulate(1003) + " --config " + rig_.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_GE(num_trunks(outcome.output), 10) << outcome.output;
  EXPECT_LE(num_trunks(outcome.output), 12) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("trunks were found; 20 or more are needed"));
  EXPECT_EQ(text_of(rig_.string() + ".bak"), before);
  EXPECT_NE(text_of(rig_), before);
}

TEST_F(CalibrateCommand, BadInputIsOneSentenceAndExitCode3) {
  std::ofstream(path("empty.lcm")).flush();
  std::ofstream(path("text.lcm")) << std::string(5000, 'x');
  for (const char* name : {"missing.lcm", "empty.lcm", "text.lcm"}) {
    const Outcome outcome = run("calibrate trunks " + path(name) + " --config " + rig_.string() +
                                " --out " + path("out.yaml"));
    EXPECT_EQ(outcome.exit_code, 3) << name << ": " << outcome.output;
    EXPECT_THAT(outcome.output, HasSubstr(name));
    EXPECT_FALSE(fs::exists(path("out.yaml")));
  }
}

TEST_F(CalibrateCommand, LearnsAppearanceAndTrunksOfAFirstMap) {
  const std::string log = simulate(1005);
  ASSERT_EQ(run("map " + log + " --config " + rig_.string() + " --out " + path("map")).exit_code,
            0);
  std::istringstream csv(text_of(path("map/map.csv")));
  std::string ids, line;
  for (std::getline(csv, line); std::getline(csv, line);) {
    if (line.find(",tree,") == std::string::npos) continue;
    ids += (ids.empty() ? "" : ",") + line.substr(0, line.find(','));
  }
  const std::string command = "calibrate trunks " + log + " --config " + rig_.string() + " --map " +
                              path("map") + " --out " + path("out.yaml") +
                              " --colour-model appearance --ids ";
  const Outcome outcome = run(command + ids);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("area under the ROC curve"));
  const auto config = io::load_config(path("out.yaml"));
  EXPECT_EQ(config.detector.colour_model, detection::ColourModel::kAppearance);
  EXPECT_NEAR(config.detector.width.mean_m, 0.090, 0.004);

  fs::remove(path("out.yaml"));
  for (const char* bad : {"9999", "4,x", "7-3"}) {
    const Outcome refused = run(command + bad);
    EXPECT_EQ(refused.exit_code, 3) << refused.output;
    EXPECT_THAT(refused.output,
                HasSubstr(bad[0] == '9' ? "no landmark has id 9999" : "neither a number"));
    EXPECT_FALSE(fs::exists(path("out.yaml")));
  }
}

TEST_F(CalibrateCommand, ALogWithoutPicturesIsRefused) {
  const std::string log = path("blind.lcm");
  const std::string config = ORCHARD_SOURCE_DIR "/config/urg_front.yaml";
  ASSERT_EQ(run("simulate --scene tubes --seed 7 --config " + config + " --out " + log).exit_code,
            0);
  const Outcome outcome =
      run("calibrate trunks " + log + " --config " + rig_.string() + " --out " + path("out.yaml"));
  EXPECT_EQ(outcome.exit_code, 3) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("no scan with a picture"));
  EXPECT_FALSE(fs::exists(path("out.yaml")));
}

/// What evaluate_windows of the experiments prints.
Outcome windows(const std::string& arguments, bool with_errors = false) {
  return run(arguments, with_errors, "experiments/evaluate_windows");
}

/// Real trunks: learnt from the first twenty pictures, judged on all others, as they are and with
/// four times the light, of which much is blown out.
TEST_F(CalibrationTest, CherryTrunksAreToldFromWhatSurroundsThem) {
  const fs::path data = fs::path(ORCHARD_DATA_DIR) / "cherry_trunks";
  if (!fs::is_directory(data)) GTEST_SKIP() << data << " is not there";
  const std::string there =
      " --images " + (data / "images").string() + " --masks " + (data / "masks").string() + " ";
  const Outcome learnt = windows(there + "--only 000-019 --out " + path("model.yaml"));
  ASSERT_EQ(learnt.exit_code, 0) << learnt.output;
  const auto judged = [&](const std::string& light) {
    const Outcome told = windows(there + "--only 020-119 --model " + path("model.yaml") + light);
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

/// Two short drives through the hard orchard, to learn and to judge by.
class LearnDecision : public CalibrationTest {
 protected:
  void SetUp() override {
    CalibrationTest::SetUp();
    simulate("learn", 41);
    simulate("judge", 42);
  }
  void simulate(const std::string& name, int seed) const {
    const std::string drive = " --scene orchard --duration 20 --seed " + std::to_string(seed) +
                              " --config " + kRig + " --out " + path(name);
    const Outcome outcome = run("simulate" + drive + ".lcm --truth " + path(name) + ".truth.csv");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    const Outcome looks = run(drive + ".looks.csv", true, "experiments/true_observations");
    ASSERT_EQ(looks.exit_code, 0) << looks.output;
  }
  double judged_f1(const std::string& rig_yaml) const {
    const std::string map = path(rig_yaml + ".map");
    EXPECT_EQ(
        run("map " + path("judge.lcm") + " --config " + path(rig_yaml) + " --quiet --out " + map)
            .exit_code,
        0);
    const Outcome outcome = run(
        map + " --observations " + path("judge.looks.csv") + " --truth " + path("judge.truth.csv"),
        false, "experiments/evaluate_detections");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    return nlohmann::json::parse(outcome.output)["observations"]["f1"].get<double>();
  }

  static constexpr const char* kRig = ORCHARD_SOURCE_DIR "/config/orchard_hard.yaml";
};

// Nobody names a tree: `calibrate trunks` finds them, learns width and colour, and from its own
// trunks how much either says.
TEST_F(LearnDecision, TrunksFoundByThemselvesTeachTheDecision) {
  const std::string learn = "calibrate trunks " + path("learn.lcm") + " --config " + kRig;
  const Outcome of_paper = run(learn + " --decision roc --out " + path("roc.yaml"));
  ASSERT_EQ(of_paper.exit_code, 0) << of_paper.output;
  EXPECT_EQ(io::load_config(path("roc.yaml")).detector.decision, detection::Decision::kRoc);
  const Outcome found = run(learn + " --decision probability --out " + path("trunks.yaml"));
  ASSERT_EQ(found.exit_code, 0) << found.output;
  EXPECT_THAT(found.output, HasSubstr("(left-out objects)"));
  const auto config = io::load_config(path("trunks.yaml"));
  EXPECT_EQ(config.detector.decision, detection::Decision::kProbability);
  EXPECT_TRUE(config.detector.probability.enabled);
  const double f1_of_paper = judged_f1("roc.yaml"), f1_found = judged_f1("trunks.yaml");
  RecordProperty("f1_of_paper", std::to_string(f1_of_paper));
  RecordProperty("f1_found", std::to_string(f1_found));
  EXPECT_GT(f1_found, f1_of_paper);
}

}  // namespace
}  // namespace orchard
