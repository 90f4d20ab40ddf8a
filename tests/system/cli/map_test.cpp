// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "system/cli/cli_fixture.hpp"

namespace orchard::cli_test {
namespace {

using ::testing::HasSubstr;

class MapCommand : public CliTest {};

TEST_F(MapCommand, WritesTheWholeFolderAndSaysWhatItFound) {
  const Result result = map(log());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  for (const char* file : {"map.csv", "map.gpkg", "map.svg", "map.png", "map.pdf", "map.html",
                           "trajectory.csv", "summary.json", "derived.lcm"}) {
    EXPECT_TRUE(exists(path("map/") + file)) << file;
  }
  EXPECT_THAT(result.out, HasSubstr("16 landmarks: 12 trees, 4 objects"));
  EXPECT_THAT(result.out, HasSubstr("losses: none"));
  EXPECT_EQ(result.err, "");  // no progress bar in a pipe
  const auto summary = nlohmann::json::parse(read_file(path("map/summary.json")));
  EXPECT_THAT(summary.dump(), HasSubstr("drive.lcm"));
}

TEST_F(MapCommand, PiecesOfALogAreMappedAsTheLogWas) {
  ASSERT_EQ(map(log()).exit_code, 0);
  // cut where an event begins, near each third
  const std::string bytes = read_file(log());
  std::vector<std::size_t> cuts{0};
  for (const std::size_t third : {bytes.size() / 3, 2 * bytes.size() / 3}) {
    cuts.push_back(bytes.find("\xED\xA1\xDA\x01", third));
  }
  cuts.push_back(bytes.size());
  for (std::size_t i = 0; i < 3; ++i) {
    write_file(path("drive." + std::to_string(i)), bytes.substr(cuts[i], cuts[i + 1] - cuts[i]));
  }
  // in another order, and the second twice
  const Result result = orchard({"map", path("drive.1"), path("drive.2"), path("drive.0"),
                                 path("drive.1"), "--out", path("pieces"), "--config", config()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("are also in another log; they are used once"));
  for (const char* file : {"map.csv", "map.gpkg", "trajectory.csv", "derived.lcm"}) {
    EXPECT_EQ(read_file(path("pieces/") + file), read_file(path("map/") + file)) << file;
  }
  const Result info = orchard({"log", "info", path("drive.2"), path("drive.0"), path("drive.1")});
  EXPECT_EQ(info.exit_code, 0) << info.err;
  EXPECT_EQ(info.out.substr(info.out.find('\n')), [&] {
    const std::string whole = orchard({"log", "info", log()}).out;
    return whole.substr(whole.find('\n'));
  }());
}

TEST_F(MapCommand, WhatIsSaidToBeWrittenIsThere) {
  const Result result = map(log());
  for (const char* file :
       {"map.csv", "map.gpkg", "map.svg", "map.png", "map.pdf", "map.html", "trajectory.csv",
        "trajectory.tum", "graph.json", "summary.json", "derived.lcm", "album"}) {
    EXPECT_TRUE(exists(path("map/") + file)) << file;
    EXPECT_THAT(result.out, HasSubstr(file));
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(path("map")), {}), 12);
}

TEST_F(MapCommand, TheMessagesOnTheWayCanBeLeftOut) {
  ASSERT_EQ(map(log()).exit_code, 0);
  const std::string csv = read_file(path("map/map.csv"));
  const Result result = map(log(), {"--no-derived"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_FALSE(exists(path("map/derived.lcm")));  // nor that of the map before
  EXPECT_THAT(result.out, ::testing::Not(HasSubstr("derived.lcm")));
  EXPECT_EQ(read_file(path("map/map.csv")), csv);
}

TEST_F(MapCommand, KeptIdsAreNoLosses) {
  const std::string drive = path("orchard.lcm");
  ASSERT_EQ(
      orchard({"simulate", "--scene", "orchard", "--duration", "8", "--out", drive}).exit_code, 0);
  const Result first = orchard({"map", drive, "--out", path("map")});
  ASSERT_EQ(first.exit_code, 0) << first.err;
  const Result later = orchard({"map", drive, "--previous", path("map"), "--out", path("later")});
  ASSERT_EQ(later.exit_code, 0) << later.err;
  const auto losses = [](const std::string& out) {
    const std::size_t begin = out.find("losses: ");
    return out.substr(begin, out.find('\n', begin) - begin);
  };
  ASSERT_THAT(first.out, HasSubstr("losses: "));
  EXPECT_EQ(losses(later.out), losses(first.out));
  EXPECT_THAT(later.out, ::testing::ContainsRegex("ids of .*map: [0-9]+ kept, 0 gone, 0 new"));
}

TEST_F(MapCommand, AnInterruptLeavesNoHalfFileBehind) {
  ASSERT_EQ(
      orchard({"simulate", "--scene", "orchard", "--duration", "8", "--out", path("long.lcm")})
          .exit_code,
      0);
  const std::string program = ORCHARD_BUILD_DIR "/bin/orchard", drive = path("long.lcm"),
                    out = path("map"), err = path("err");
  std::vector<const char*> argv{program.c_str(), "map",       drive.c_str(),
                                "--out",         out.c_str(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), O_WRONLY | O_CREAT, 0600);
  pid_t pid = 0;
  ASSERT_EQ(posix_spawn(&pid, argv[0], &actions, nullptr, const_cast<char**>(argv.data()), environ),
            0);
  posix_spawn_file_actions_destroy(&actions);
  while (!exists(path("map/derived.lcm.part"))) usleep(1000);
  ASSERT_EQ(kill(pid, SIGINT), 0);
  int status = 0;
  waitpid(pid, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 1);
  EXPECT_THAT(read_file(err), HasSubstr("interrupted"));
  EXPECT_TRUE(std::filesystem::is_empty(path("map")));
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

// A terminal as `script` makes one; without one nothing is drawn (WritesTheWholeFolder...).
TEST_F(MapCommand, ATerminalSeesProgress) {
  const std::string command =
      ORCHARD_BUILD_DIR "/bin/orchard map " + log() + " --out " + path("map");
  const Result result = run({"script", "-qec", command, "/dev/null"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, HasSubstr("mapping ["));
  EXPECT_THAT(result.out, HasSubstr("100 %"));
}

TEST_F(MapCommand, HelpNamesTheRigsWhereTheyLie) {
  std::filesystem::create_directories(path("usr/bin"));
  std::filesystem::create_directories(path("usr/share/orchard-mapper/config"));
  std::filesystem::copy(ORCHARD_BUILD_DIR "/bin/orchard", path("usr/bin/orchard"));
  EXPECT_THAT(run({path("usr/bin/orchard"), "help", "calibrate", "trunks"}).out,
              HasSubstr("--config " + path("usr/share/orchard-mapper/config/tubes.yaml")));
  EXPECT_THAT(orchard({"help", "calibrate", "trunks"}).out,
              HasSubstr("--config config/tubes.yaml"));
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
