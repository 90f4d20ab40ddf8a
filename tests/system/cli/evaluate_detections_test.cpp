// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "system/cli/cli_fixture.hpp"

namespace orchard::cli_test {
namespace {

using ::testing::HasSubstr;

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
