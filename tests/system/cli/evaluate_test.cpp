// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "system/cli/cli_fixture.hpp"

namespace orchard::cli_test {
namespace {

using ::testing::HasSubstr;

class EvaluateCommand : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    write_file(path("map.csv"), std::string(kMapHeader) +
                                    "1,tree,1.003,2.004,5,0.9,0.99,0.004,0.006,0.09,,\n"
                                    "2,object,4,0,5,0.001,0.01,0.004,0.006,0.17,,\n");
    write_file(path("truth.csv"), "class,x_m,y_m,width_m\ntree,1,2,0.09\nobject,4,0,0.17\n");
  }
  Result evaluate(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"evaluate", path("map.csv"), "--truth", path("truth.csv")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return orchard(arguments);
  }
};

TEST_F(EvaluateCommand, PrintsThePapersTables) {
  const Result result = evaluate();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("ROC_tree_mean  SE_x (mm)  SE_y (mm)"));
  EXPECT_THAT(result.out, ::testing::ContainsRegex("T1 +5 +0.900 +4.00 +6.00 +5.00\n"));
  EXPECT_THAT(result.out, HasSubstr("found 2 of 2"));
}

TEST_F(EvaluateCommand, JsonIsForPrograms) {
  const auto json = nlohmann::json::parse(evaluate({"--json"}).out);
  EXPECT_EQ(json["perfect"], true);
  EXPECT_NEAR(json["objects"][0]["error_m"].get<double>(), 0.005, 1e-9);
}

TEST_F(EvaluateCommand, CheckAsksForAPerfectMap) {
  EXPECT_EQ(evaluate({"--check"}).exit_code, 0);
  EXPECT_EQ(evaluate({"--check", "--gate", "0.004"}).exit_code, 1);  // the tree is 5 mm off
  EXPECT_EQ(evaluate({"--gate", "0.004"}).exit_code, 0);
  write_file(path("truth.csv"), "class,x_m,y_m,width_m\nobject,1,2,0.09\nobject,4,0,0.17\n");
  EXPECT_EQ(evaluate({"--check"}).exit_code, 1);
}

TEST_F(EvaluateCommand, ASimulatedDriveIsMappedPerfectly) {
  ASSERT_EQ(map(log()).exit_code, 0);
  const Result result = orchard({"evaluate", path("map"), "--truth", truth(), "--check"});
  EXPECT_EQ(result.exit_code, 0) << result.out;
}

TEST_F(EvaluateCommand, FilesThatAreNotWhatTheyShouldBe) {
  const Result missing = orchard({"evaluate", path("none.csv"), "--truth", path("truth.csv")});
  EXPECT_EQ(missing.exit_code, 3);
  EXPECT_THAT(missing.err, HasSubstr("none.csv"));
  write_file(path("truth.csv"), "class,x_m,y_m,width_m\ntree,1,two,0.09\n");
  const Result bad = evaluate();
  EXPECT_EQ(bad.exit_code, 3);
  EXPECT_THAT(bad.err, HasSubstr("truth.csv:2"));
  EXPECT_EQ(count_lines(bad.err), 1);
  EXPECT_EQ(orchard({"evaluate", path("map.csv")}).exit_code, 2);
}

class EvaluateTrajectoryCommand : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    // the truth drives along x; the estimate along y, 5 m away: the same but for its place
    std::string truth = "utime_us,x_m,y_m,yaw_rad\n", estimate = truth;
    for (int i = 0; i < 20; ++i) {
      const std::string utime = std::to_string(1000000 * i);
      truth += utime + "," + std::to_string(i) + ",0,0\n";
      estimate += utime + ",5," + std::to_string(i) + ",1.5707963\n";
    }
    write_file(path("truth.csv"), truth);
    write_file(path("trajectory.csv"), estimate);
  }
  Result evaluate(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"evaluate", "trajectory", path("trajectory.csv"), "--truth",
                                       path("truth.csv")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return orchard(arguments);
  }
};

TEST_F(EvaluateTrajectoryCommand, Aligns) {
  const auto raw = nlohmann::json::parse(evaluate({"--json"}).out);
  EXPECT_NEAR(raw["ape_yaw_rad"]["rmse"].get<double>(), 1.5707963, 1e-6);
  EXPECT_EQ(raw["num_compared"], 20);
  const Result result = evaluate({"--align"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("rotated by -90.000 degrees"));
  EXPECT_THAT(result.out, ::testing::ContainsRegex("APE position \\(ATE\\) +20 +0.0000"));
  EXPECT_EQ(evaluate({"--align-origin"}).exit_code, 0);
}

TEST_F(EvaluateTrajectoryCommand, TakesATruthOfPositionsWithGaps) {
  std::string truth = "x_m,y_m,quality,utime_us\n";
  for (int i = 0; i < 20; ++i) {
    if (i > 8 && i < 14) continue;
    truth += std::to_string(i) + ",0,4," + std::to_string(1000000 * i) + "\n";
  }
  write_file(path("truth.csv"), truth);
  const auto json = nlohmann::json::parse(evaluate({"--align", "--json"}).out);
  EXPECT_EQ(json["num_in_gaps"], 5);
  EXPECT_EQ(json["num_compared"], 15);
  EXPECT_EQ(json["has_yaw"], false);
  EXPECT_NEAR(json["ape_position_m"]["max"].get<double>(), 0.0, 1e-9);
  EXPECT_EQ(json["ape_yaw_rad"]["n"], 0);
  EXPECT_EQ(nlohmann::json::parse(evaluate({"--gap", "10", "--json"}).out)["num_in_gaps"], 0);
}

TEST_F(EvaluateTrajectoryCommand, SaysWhatIsWrong) {
  const auto refused = [&](const std::string& why) {
    const Result result = evaluate();
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_THAT(result.err, HasSubstr(why));
  };
  write_file(path("truth.csv"), "utime_us,x_m\n1,2\n");
  refused("a track needs the columns utime_us, x_m and y_m");
  write_file(path("truth.csv"), "utime_us,x_m,y_m\n");
  refused("has no poses");
  write_file(path("truth.csv"), "utime_us,x_m,y_m\n2,0,0\n1,0,0\n");
  refused("truth.csv:3:1: utime_us: 1 is not later than 2");
  write_file(path("truth.csv"), "utime_us,x_m,y_m\n2,nan,0\n");
  refused("truth.csv:2:3");
  // sound, but of another day
  write_file(path("truth.csv"), "utime_us,x_m,y_m\n99000000,0,0\n99100000,0,0\n");
  const Result nothing = evaluate();
  EXPECT_EQ(nothing.exit_code, 1);
  EXPECT_THAT(nothing.err, HasSubstr("nothing can be compared"));
  EXPECT_EQ(evaluate({"--align", "--align-origin"}).exit_code, 2);
  EXPECT_EQ(evaluate({"--unit", "feet"}).exit_code, 2);
}

TEST_F(EvaluateTrajectoryCommand, AMapIsLaidUponTheTruth) {
  std::string map = kMapHeader;
  std::string truth = "class,x_m,y_m,width_m\n";
  for (int i = 0; i < 12; ++i) {
    const int x = 4 * (i / 4), y = 2 * (i % 4) + i / 7;  // no two shifts look alike
    truth += "tree," + std::to_string(x) + "," + std::to_string(y) + ",0.1\n";
    map += std::to_string(i + 1) + ",tree," + std::to_string(x + 1.5) + "," +
           std::to_string(y - 2.0) + ",5,0.9,0.99,0.004,0.006,0.1,,\n";
  }
  write_file(path("map.csv"), map);
  write_file(path("trees.csv"), truth);
  const Result result =
      orchard({"evaluate", "map", path("map.csv"), "--truth", path("trees.csv"), "--align"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("moved by (-1.500, 2.000) m"));
  EXPECT_THAT(result.out, HasSubstr("trees: missed 0 of 12, mapped twice 0, error RMS 0.00 mm"));
  EXPECT_EQ(orchard({"evaluate", "map", path("map.csv"), "--truth", path("trees.csv"),
                     "--align-offset", "3"})
                .exit_code,
            2);
}

/// A drive through the tube scene with the truth of each scan, and its map.
class EvaluateDetections : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    ASSERT_EQ(orchard({"simulate", "--scene", "tubes", "--seed", "5", "--config", config(), "--out",
                       path("drive.lcm"), "--truth", path("truth.csv")})
                  .exit_code,
              0);
    observe("5", path("looks.csv"));
    ASSERT_EQ(map(path("drive.lcm")).exit_code, 0);
  }
  static Result experiment(const std::string& name, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), ORCHARD_BUILD_DIR "/experiments/" + name);
    return run(arguments);
  }
  Result evaluate(const std::vector<std::string>& more) const {
    return experiment("evaluate_detections", more);
  }
  void observe(const std::string& seed, const std::string& csv) const {
    const Result result = experiment("true_observations", {"--scene", "tubes", "--seed", seed,
                                                           "--config", config(), "--out", csv});
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }
  void expect_refused(const Result& result, const std::string& why) const {
    EXPECT_EQ(result.exit_code, 3) << result.out;
    EXPECT_THAT(result.err, HasSubstr(why));
    EXPECT_EQ(count_lines(result.err), 1) << result.err;
  }
};

TEST_F(EvaluateDetections, TubesAreFoundScanByScan) {
  const Result result =
      evaluate({path("map"), "--observations", path("looks.csv"), "--truth", path("truth.csv")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["observations"]["num_wrong"], 0);
  EXPECT_GT(json["observations"]["num_right"], 40);
  EXPECT_GT(json["observations"]["recall"], 0.8);
  EXPECT_EQ(json["landmarks"]["num_right"], 12);
  EXPECT_LT(json["by_range"][0]["centre_error"]["rms_m"], 0.03);
}

TEST_F(EvaluateDetections, ProbabilitiesAreLearntAndThenStated) {
  // What the laser refuses no camera judges; of the rest one tube per scene is of another colour.
  std::vector<std::string> drives, derived, observations;
  for (const std::string seed : {"5", "6", "7", "8"}) {
    drives.push_back(path("drive_" + seed + ".lcm"));
    observations.push_back(path("looks_" + seed + ".csv"));
    derived.push_back(path("map_" + seed + "/derived.lcm"));
    ASSERT_EQ(orchard({"simulate", "--scene", "tubes", "--seed", seed, "--config", config(),
                       "--out", drives.back()})
                  .exit_code,
              0);
    observe(seed, observations.back());
    ASSERT_EQ(orchard({"map", drives.back(), "--config", config(), "--out", path("map_" + seed)})
                  .exit_code,
              0);
  }
  const auto learn = [&](const std::vector<std::string>& logs, const std::string& rig) {
    std::vector<std::string> arguments = logs;
    arguments.push_back("--observations");
    arguments.insert(arguments.end(), observations.begin(), observations.end());
    for (const std::string& a : {std::string("--config"), config(), std::string("--out"), rig}) {
      arguments.push_back(a);
    }
    return experiment("learn_probability", arguments);
  };
  const Result learnt = learn(drives, path("rig.yaml"));
  ASSERT_EQ(learnt.exit_code, 0) << learnt.err;
  EXPECT_THAT(learnt.out, HasSubstr("roc_edges"));
  // from the derived logs the same is learnt, to the byte
  const Result again = learn(derived, path("again.yaml"));
  ASSERT_EQ(again.exit_code, 0) << again.err;
  const auto weights = [](const std::string& yaml) {
    return yaml.substr(yaml.find("judged_tree"), 300);
  };
  EXPECT_EQ(weights(read_file(path("rig.yaml"))), weights(read_file(path("again.yaml"))));

  ASSERT_EQ(
      orchard({"map", path("drive.lcm"), "--config", path("rig.yaml"), "--out", path("stated")})
          .exit_code,
      0);
  const auto json =
      nlohmann::json::parse(evaluate({path("stated"), "--observations", path("looks.csv")}).out);
  EXPECT_LT(json["probability"]["expected_calibration_error"], 0.1);
}

TEST_F(EvaluateDetections, FilesThatAreNotWhatTheyShouldBe) {
  expect_refused(evaluate({path("map"), "--observations", path("truth.csv")}), "truth.csv:1");
  expect_refused(evaluate({path("map"), path("map"), "--observations", path("looks.csv")}),
                 "one --observations per recording");
  expect_refused(evaluate({path("drive.lcm"), "--observations", path("looks.csv")}),
                 "has no valid DETECTIONS message");
  expect_refused(evaluate({path("none"), "--observations", path("looks.csv")}), "none");
  std::string other = read_file(path("looks.csv"));
  for (auto at = other.find("\n13"); at != std::string::npos; at = other.find("\n13", at + 1)) {
    other[at + 2] = '4';  // another year
  }
  write_file(path("other.csv"), other);
  expect_refused(evaluate({path("map"), "--observations", path("other.csv")}),
                 "no time stamp is equal");
  expect_refused(
      experiment("learn_probability", {path("drive.lcm"), "--observations", path("other.csv"),
                                       "--config", config(), "--out", path("rig.yaml")}),
      "no time stamp is equal");
  EXPECT_FALSE(exists(path("rig.yaml")));
}

}  // namespace

}  // namespace orchard::cli_test
