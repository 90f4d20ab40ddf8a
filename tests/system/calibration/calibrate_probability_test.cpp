// SPDX-License-Identifier: BSD-3-Clause
// `orchard calibrate probability` from a map whose trees are known, as people run it.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "io/config/config_edit.hpp"
#include "io/map/map_csv.hpp"
#include "io/recording/truth_csv.hpp"
#include "system/calibration/run_orchard.hpp"

namespace orchard {
namespace {

namespace fs = std::filesystem;

/// A short drive through the hard orchard with its truth, and its map.
class CalibrateProbability : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("orchard_probability_" + std::to_string(getpid()));
    fs::create_directories(folder_);
    simulate("learn", 41);
    ASSERT_EQ(run("map " + at("learn.lcm") + rig() + " --quiet --out " + at("learn")).exit_code, 0);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string at(const std::string& name) const { return (folder_ / name).string(); }
  std::string rig() const { return " --config " + rig_; }
  void simulate(const std::string& name, int seed) const {
    const std::string drive =
        " --scene orchard --duration 20 --seed " + std::to_string(seed) + rig() + " --out ";
    const Outcome outcome =
        run("simulate" + drive + at(name + ".lcm") + " --truth " + at(name + ".truth.csv"));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    const Outcome looks =
        run(drive + at(name + ".looks.csv"), true, "experiments/true_observations");
    ASSERT_EQ(looks.exit_code, 0) << looks.output;
  }
  /// Learns from `source` into out.yaml.
  Outcome learn(const std::string& source, const std::string& out = "out.yaml") const {
    return run("calibrate probability " + at("learn.lcm") + rig() + " --out " + at(out) + source);
  }
  void expect_refused(const std::string& source, const std::string& why) const {
    const Outcome outcome = learn(source);
    EXPECT_EQ(outcome.exit_code, 3) << outcome.output;
    EXPECT_NE(outcome.output.find(why), std::string::npos) << outcome.output;
    EXPECT_FALSE(fs::exists(at("out.yaml")));
  }
  /// Ids of the landmarks that are the nearest of a true tree: what a person would pick.
  std::string picked() const {
    const auto landmarks = io::read_map_csv(at("learn/map.csv"));
    std::string ids;
    for (const simulation::TruthObject& object : io::read_truth_csv(at("learn.truth.csv"))) {
      if (object.label != detection::Label::kTree) continue;
      double nearest_m = 0.3;
      int id = 0;
      for (const auto& l : landmarks) {
        const double away_m = std::hypot(l.x_m - object.x_m, l.y_m - object.y_m);
        if (away_m >= nearest_m) continue;
        nearest_m = away_m;
        id = l.id;
      }
      if (id > 0) ids += (ids.empty() ? "" : ",") + std::to_string(id);
    }
    return ids;
  }
  double judged_f1(const std::string& rig_yaml) const {
    const std::string map = at(rig_yaml + ".map");
    EXPECT_EQ(run("map " + at("judge.lcm") + " --config " + at(rig_yaml) + " --quiet --out " + map)
                  .exit_code,
              0);
    const Outcome outcome = run(map + " --observations " + at("judge.looks.csv") +
                                    " --truth " + at("judge.truth.csv"),
                                false, "experiments/evaluate_detections");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    return nlohmann::json::parse(outcome.output)["observations"]["f1"].get<double>();
  }

  fs::path folder_;
  std::string rig_ = ORCHARD_SOURCE_DIR "/config/orchard_hard.yaml";
};

TEST_F(CalibrateProbability, AMapWithPickedTreesTeachesWhatTheTruthTeaches) {
  // With the appearance model, every tree near enough is found, however the weights are learnt.
  io::edit_config_file(rig_, at("rig.yaml"), {{"detector.colour_model", "hue_interval"}}, "", "");
  rig_ = at("rig.yaml");
  const Outcome of_truth = run(at("learn.lcm") + rig() + " --out " + at("truth.yaml") +
                                   " --observations " + at("learn.looks.csv"),
                               true, "experiments/learn_probability");
  ASSERT_EQ(of_truth.exit_code, 0) << of_truth.output;
  const Outcome of_map = learn(" --map " + at("learn") + " --ids " + picked(), "map.yaml");
  ASSERT_EQ(of_map.exit_code, 0) << of_map.output;
  EXPECT_EQ(of_map.output.find("warning"), std::string::npos) << of_map.output;
  EXPECT_NE(of_map.output.find("objects of one recording"), std::string::npos) << of_map.output;
  simulate("judge", 42);
  const double f1_of_truth = judged_f1("truth.yaml"), f1_of_map = judged_f1("map.yaml");
  RecordProperty("f1_of_truth", std::to_string(f1_of_truth));
  RecordProperty("f1_of_map", std::to_string(f1_of_map));
  EXPECT_GT(f1_of_truth, 0.85);
  EXPECT_NEAR(f1_of_map, f1_of_truth, 0.03);
}

TEST_F(CalibrateProbability, WithoutIdsItLearnsTheCorrectedClasses) {
  const Outcome unchecked = learn(" --map " + at("learn"), "unchecked.yaml");
  ASSERT_EQ(unchecked.exit_code, 0) << unchecked.output;
  EXPECT_NE(unchecked.output.find("nobody has corrected"), std::string::npos) << unchecked.output;
  int num_trees = 0;
  std::string tree;
  for (const auto& l : io::read_map_csv(at("learn/map.csv"))) {
    if (l.label != detection::Label::kTree) continue;
    ++num_trees;
    tree = std::to_string(l.id);
  }
  EXPECT_NE(unchecked.output.find("of " + std::to_string(num_trees) + " trees"), std::string::npos);
  ASSERT_EQ(run("edit " + at("learn") + " class " + tree + " object").exit_code, 0);
  const Outcome checked = learn(" --map " + at("learn"), "checked.yaml");
  ASSERT_EQ(checked.exit_code, 0) << checked.output;
  EXPECT_EQ(checked.output.find("nobody has corrected"), std::string::npos) << checked.output;
  EXPECT_NE(checked.output.find("of " + std::to_string(num_trees - 1) + " trees"),
            std::string::npos)
      << checked.output;
  ASSERT_EQ(run("edit " + at("learn") + " undo").exit_code, 0);
  const Outcome undone = learn(" --map " + at("learn"), "undone.yaml");
  EXPECT_NE(undone.output.find("nobody has corrected"), std::string::npos) << undone.output;
}

// Nobody names a tree: `calibrate trunks` finds them, learns width and colour, and from its own
// trunks how much either says.
TEST_F(CalibrateProbability, TrunksFoundByThemselvesTeachTheDecision) {
  const std::string learn = "calibrate trunks " + at("learn.lcm") + rig();
  const Outcome of_paper = run(learn + " --decision roc --out " + at("roc.yaml"));
  ASSERT_EQ(of_paper.exit_code, 0) << of_paper.output;
  EXPECT_EQ(io::load_config(at("roc.yaml")).detector.decision, detection::Decision::kRoc);
  const Outcome found = run(learn + " --decision probability --out " + at("trunks.yaml"));
  ASSERT_EQ(found.exit_code, 0) << found.output;
  EXPECT_NE(found.output.find("(left-out objects)"), std::string::npos) << found.output;
  const auto config = io::load_config(at("trunks.yaml"));
  EXPECT_EQ(config.detector.decision, detection::Decision::kProbability);
  EXPECT_TRUE(config.detector.probability.enabled);
  simulate("judge", 42);
  const double f1_of_paper = judged_f1("roc.yaml"), f1_found = judged_f1("trunks.yaml");
  RecordProperty("f1_of_paper", std::to_string(f1_of_paper));
  RecordProperty("f1_found", std::to_string(f1_found));
  EXPECT_GT(f1_found, f1_of_paper);
}

TEST_F(CalibrateProbability, BadInputIsOneSentence) {
  const std::string map = " --map " + at("learn");
  expect_refused(map + " --ids 4,777777,888888", "no landmark has id 777777, 888888");
  expect_refused(map + " --ids 4,x", "neither a number");
  expect_refused(" --map " + at("learn/map.csv"), "has no trajectory.csv");
  expect_refused(map + " " + at("learn"), "there are 1 logs and 2 maps");
  std::string all;
  for (const auto& l : io::read_map_csv(at("learn/map.csv"))) {
    all += (all.empty() ? "" : ",") + std::to_string(l.id);
  }
  expect_refused(map + " --ids " + all, "and 0 objects, but both are needed");
  // The same map in a frame that is 1.3 m to the side, and one of another day.
  const std::string csv = text_of(at("learn/map.csv")), path = text_of(at("learn/trajectory.csv"));
  auto landmarks = io::read_map_csv(at("learn/map.csv"));
  for (auto& l : landmarks) l.y_m += 1.3;
  std::ofstream(at("learn/map.csv")) << io::map_csv(landmarks);
  expect_refused(map, "are at a landmark of");
  std::ofstream(at("learn/map.csv")) << csv;
  std::ofstream(at("learn/trajectory.csv"))
      << path.substr(0, path.find('\n') + 1) << "7000000,0.0,0.0,0.0\n8000000,0.0,0.0,0.0\n";
  expect_refused(map, "has no pose at the time of any scan");
  for (const std::string& source :
       {std::string(), std::string(" --ids 4"), map + " " + at("learn") + " --ids 4"}) {
    EXPECT_EQ(learn(source).exit_code, 2) << source;
  }
}

}  // namespace
}  // namespace orchard
