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

/// Two rows along the first column, at the given places of the second; with 0 between them the
/// truth drives in their middle.
std::string two_rows(const std::string& header, const std::string& one, const std::string& other) {
  std::string csv = header + "\n";
  for (int i = 0; i < 40; ++i) {
    csv += std::to_string(i / 2) + "," + (i % 2 == 0 ? one : other) + "\n";
  }
  return csv;
}

TEST_F(EvaluateTrajectoryCommand, JudgesByTheRowsOfASurvey) {
  std::string estimate = "utime_us,x_m,y_m,yaw_rad\n";
  for (int i = 0; i < 20; ++i) {
    estimate +=
        std::to_string(1000000 * i) + "," + std::to_string(i) + (i < 5 ? ",3,0\n" : ",0.5,0\n");
  }
  write_file(path("trajectory.csv"), estimate);
  write_file(path("survey.csv"), two_rows("x_m,y_m", "-2", "2"));
  const auto json =
      nlohmann::json::parse(evaluate({"--rows", path("survey.csv"), "--json"}).out)["rows"];
  EXPECT_EQ(json["num_rows"], 2);
  EXPECT_EQ(json["right_aisle"], 0.75);
  EXPECT_NEAR(json["cross_track_median_m"].get<double>(), 0.5, 1e-6);
  EXPECT_NEAR(json["wrong_longest_s"].get<double>(), 4.0, 1e-6);
  const Result said = evaluate({"--rows", path("survey.csv")});
  EXPECT_EQ(said.exit_code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("right aisle: 75.0 % of them"));
}

TEST_F(EvaluateTrajectoryCommand, JudgesByTheRowsOfAMap) {
  std::string map = kMapHeader;
  for (int i = 0; i < 40; ++i) {
    map += std::to_string(i + 1) + ",tree," + std::to_string(i / 2) +
           (i % 2 == 0 ? ",-2," : ",2,") + "5,0.9,0.99,0.004,0.006,0.09," +
           std::to_string(i % 2 + 1) + "," + std::to_string(i / 2 + 1) + "\n";
  }
  write_file(path("map.csv"), map);
  const auto json =
      nlohmann::json::parse(evaluate({"--align", "--rows", path("map.csv"), "--json"}).out)["rows"];
  EXPECT_EQ(json["num_in_aisles"], 20);
  EXPECT_EQ(json["right_aisle"], 1.0);
}

TEST_F(EvaluateTrajectoryCommand, SaysWhatIsWrongWithRows) {
  const auto refused = [&](const std::string& why) {
    const Result result = evaluate({"--rows", path("rows.csv")});
    EXPECT_EQ(result.exit_code, 3) << result.out;
    EXPECT_THAT(result.err, HasSubstr(why));
  };
  refused("rows.csv");  // there is none
  write_file(path("rows.csv"),
             std::string(kMapHeader) + "1,tree,1,2,5,0.9,0.99,0.004,0.006,0.09,,\n");
  refused("fewer than two rows");
  write_file(path("rows.csv"), "name,kind\nv1,vine\n");
  refused("no columns with positions");
  write_file(path("rows.csv"), "x_m,y_m\n1,nan\n");
  refused("feature 1");
  write_file(path("rows.csv"), two_rows("x_m,y_m", "98", "102"));  // elsewhere
  refused("in one frame, in metres, x and y in this order");
  std::string degrees = "lat,lon\n";
  for (int i = 0; i < 40; ++i) {
    degrees += "53.000" + std::to_string(10 + i / 2) + (i % 2 == 0 ? ",5.00000\n" : ",5.00006\n");
  }
  write_file(path("rows.csv"), degrees);
  refused("is in degrees");
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

}  // namespace

}  // namespace orchard::cli_test
