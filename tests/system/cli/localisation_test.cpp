// SPDX-License-Identifier: BSD-3-Clause
// A survey as the map: a block is surveyed by the simulator's own truth, without classes and
// widths, and a drive through it is located there.
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "system/cli/cli_fixture.hpp"

namespace orchard::cli_test {
namespace {

using ::testing::HasSubstr;

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

class LocalisationCommand : public CliTest {
 protected:
  /// A small block with external fixes, and its truth as a survey: only x and y.
  void simulate() {
    std::string rig = read_file(ORCHARD_SOURCE_DIR "/config/block.yaml");
    rig = replaced(rig, "num_rows: 10", "num_rows: 4");
    rig = replaced(rig, "trees_per_row: 30", "trees_per_row: 14");
    rig = replaced(rig, "laps: 3", "laps: 1");
    rig = replaced(rig, "mode: slam", "mode: fixes");
    rig = replaced(rig, "fix_rate_hz: 0", "fix_rate_hz: 10");
    write_file(path("rig.yaml"), rig);
    ASSERT_EQ(orchard({"simulate", "--scene", "orchard", "--seed", "1", "--config",
                       path("rig.yaml"), "--duration", "45", "--out", path("day.lcm"), "--truth",
                       path("truth.csv"), "--poses", path("poses.csv")})
                  .exit_code,
              0);
    const std::string points = orchard({"plan", path("truth.csv"), "--csv"}).out;
    std::string survey = "east,north\n";
    std::istringstream lines(points);
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
      survey += line.substr(0, line.find(',', line.find(',') + 1)) + "\n";
    }
    write_file(path("survey.csv"), survey);
  }
  Result evaluate(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"evaluate", "localisation", path("day.lcm"), "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return orchard(arguments);
  }
};

TEST_F(LocalisationCommand, LocatesADriveInASurvey) {
  simulate();
  const Result result = evaluate({"--map", path("survey.csv"), "--truth", path("poses.csv"),
                                  "--out", path("shadow"), "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_GT(json["placed_time_share"].get<double>(), 0.5) << result.out;
  EXPECT_LT(json["position_rms_m"].get<double>(), 0.1) << result.out;
  EXPECT_EQ(json["wrong_s"], 0.0);
  EXPECT_GT(json["within"][1]["way_share"].get<double>(), 0.5);
  EXPECT_THAT(read_file(path("shadow/localisation.csv")), HasSubstr(",placed,"));
  EXPECT_THAT(read_file(path("shadow/trajectory.csv")), HasSubstr("utime_us,x_m,y_m,yaw_rad"));
  // the same from the log's own fixes, as text
  const Result said = evaluate({"--map", path("survey.csv")});
  EXPECT_EQ(said.exit_code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("within 0.3 m:"));
  EXPECT_THAT(said.out, HasSubstr("wrong without a warning"));
}

TEST_F(LocalisationCommand, MapsWithASurveyAsThePriorMap) {
  simulate();
  const std::string rig = read_file(path("rig.yaml"));
  write_file(path("day2.yaml"), replaced(rig, "mode: fixes",
                                         "mode: prior_map\n  prior_map: {map_file: " +
                                             path("survey.csv") + ", survey_sd_m: 0.05}"));
  const Result mapped = orchard({"map", path("day.lcm"), "--config", path("day2.yaml"), "--out",
                                 path("map"), "--quiet", "--no-derived"});
  ASSERT_EQ(mapped.exit_code, 0) << mapped.err;
  const Result judged = orchard({"evaluate", "trajectory", path("map"), "--truth",
                                 path("poses.csv"), "--rows", path("truth.csv"), "--json"});
  ASSERT_EQ(judged.exit_code, 0) << judged.err;
  EXPECT_EQ(nlohmann::json::parse(judged.out)["rows"]["right_aisle"], 1.0) << judged.out;
}

TEST_F(LocalisationCommand, SaysWhatIsWrongWithASurvey) {
  const auto refused = [&](const std::string& survey, const std::string& why) {
    write_file(path("survey.csv"), survey);
    const Result result = orchard({"evaluate", "localisation", log(), "--map", path("survey.csv"),
                                   "--truth", path("poses.csv")});
    EXPECT_EQ(result.exit_code, 3) << result.out;
    EXPECT_THAT(result.err, HasSubstr(path("survey.csv") + " (pose.prior_map.map_file)"));
    EXPECT_THAT(result.err, HasSubstr(why));
  };
  write_file(path("poses.csv"), "utime_us,x_m,y_m\n0,0,0\n1000000,1,0\n");
  refused("x_m,y_m\n1,nan\n2,2\n3,3\n", "feature 1");
  refused("x_m,y_m\n1,1\n2,2\n", "has only 2 landmarks");
  refused("x_m,y_m\n1,1\n400,2\n2,800\n", "is not in metres");
  refused("name,kind\n1,vine\n", "no columns with positions");
}

TEST_F(LocalisationCommand, NeedsATruth) {
  write_file(path("survey.csv"), "x_m,y_m\n1,1\n4,1\n7,1\n");
  ASSERT_EQ(orchard({"simulate", "--scene", "orchard", "--config",
                     ORCHARD_SOURCE_DIR "/config/block.yaml", "--duration", "2", "--out",
                     path("no_fixes.lcm")})
                .exit_code,
            0);
  const Result result =
      orchard({"evaluate", "localisation", path("no_fixes.lcm"), "--map", path("survey.csv")});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("no POSE_FIX to compare with"));
  const Result no_map = orchard({"evaluate", "localisation", log(), "--truth", path("survey.csv")});
  EXPECT_EQ(no_map.exit_code, 3);
  EXPECT_THAT(no_map.err, HasSubstr("give a map with --map"));
}

}  // namespace
}  // namespace orchard::cli_test
