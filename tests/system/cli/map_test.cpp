// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "system/cli/cli_fixture.hpp"

namespace orchard::cli_test {
namespace {

using ::testing::HasSubstr;

class MapCommand : public CliTest {};

TEST_F(MapCommand, WritesTheWholeFolderAndSaysWhatItFound) {
  const Result result = map(log());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  for (const char* file : {"map.csv", "map.gpkg", "map.svg", "map.png", "trajectory.csv",
                           "summary.json", "derived.lcm"}) {
    EXPECT_TRUE(exists(path("map/") + file)) << file;
  }
  EXPECT_THAT(result.out, HasSubstr("16 landmarks: 12 trees, 4 objects"));
  EXPECT_THAT(result.out, HasSubstr("losses: none"));
  EXPECT_EQ(result.err, "");  // no progress bar in a pipe
  const auto summary = nlohmann::json::parse(read_file(path("map/summary.json")));
  EXPECT_THAT(summary.dump(), HasSubstr("drive.lcm"));
}

TEST_F(MapCommand, TheSameLogGivesTheSameBytes) {
  ASSERT_EQ(map(log(), {"--quiet"}).exit_code, 0);
  const std::string first = read_file(path("map/map.csv"));
  const std::string derived = read_file(path("map/derived.lcm"));
  const std::string trajectory = read_file(path("map/trajectory.csv"));
  const std::string summary = read_file(path("map/summary.json"));
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(map(log(), {"--quiet"}).exit_code, 0);
    EXPECT_EQ(read_file(path("map/map.csv")), first);
    EXPECT_TRUE(read_file(path("map/derived.lcm")) == derived);
    EXPECT_EQ(read_file(path("map/trajectory.csv")), trajectory);
    EXPECT_EQ(read_file(path("map/summary.json")), summary);
  }
}

TEST_F(MapCommand, QuietSaysNothing) {
  const Result result = map(log(), {"--quiet"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(result.err, "");
}

TEST_F(MapCommand, DerivedMessagesAreAReadableLog) {
  ASSERT_EQ(map(log()).exit_code, 0);
  const Result result = orchard({"log", "check", path("map/derived.lcm")});
  EXPECT_EQ(result.exit_code, 0) << result.out;
  EXPECT_THAT(orchard({"log", "info", path("map/derived.lcm")}).out, HasSubstr("DETECTIONS"));
}

TEST_F(MapCommand, SimulationIsRepeatable) {
  for (const char* name : {"a.lcm", "b.lcm"}) {
    ASSERT_EQ(orchard({"simulate", "--scene", "tubes", "--seed", "3", "--out", path(name),
                       "--config", config()})
                  .exit_code,
              0);
  }
  EXPECT_TRUE(read_file(path("a.lcm")) == read_file(path("b.lcm")));
  EXPECT_TRUE(read_file(path("a.lcm")) == read_file(log()));
}

TEST_F(MapCommand, SimulationStopsAfterTheDuration) {
  const Result result = orchard({"simulate", "--scene", "orchard", "--seed", "1", "--out",
                                 path("short.lcm"), "--poses", path("poses.csv"), "--duration",
                                 "1.5", "--config", ORCHARD_SOURCE_DIR "/config/orchard.yaml"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(num_messages(path("short.lcm"), "SCAN"), 16);      // 10 Hz from 0 to 1.5 s
  EXPECT_EQ(num_messages(path("short.lcm"), "ODOMETRY"), 76);  // 50 Hz
  EXPECT_EQ(count_lines(read_file(path("poses.csv"))), 17);    // a header, and one per scan
}

}  // namespace
}  // namespace orchard::cli_test
