// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <gmock/gmock.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "bus/messages/codec.hpp"
#include "io/log/log_reader.hpp"
#include "io/log/log_writer.hpp"
#include "system/cli/cli_fixture.hpp"

namespace orchard::cli_test {
namespace {

using ::testing::HasSubstr;

TEST(CommandLine, HelpIsEnoughToStart) {
  const Result result = orchard({"--help"});
  EXPECT_EQ(result.exit_code, 0);
  for (const char* command :
       {"simulate", "import", "map", "evaluate", "log", "echo", "doctor", "calibrate",
        "Exit codes: 0 success, 1 failed or interrupted, 2 bad command line"}) {
    EXPECT_THAT(result.out, HasSubstr(command));
  }
}

/// The commands that a help lists.
std::vector<std::string> commands_in(const std::string& help) {
  std::vector<std::string> commands;
  std::istringstream lines(help.substr(std::min(help.find("Commands:\n"), help.size())));
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line) && !line.empty()) {
    commands.push_back(line.substr(2, line.find(' ', 2) - 2));
  }
  return commands;
}

/// Checks help and version of a command and of those below it; returns the number of them all.
int check_help(const std::vector<std::string>& command) {
  std::vector<std::string> help{"help"}, long_help(command), version(command);
  help.insert(help.end(), command.begin(), command.end());
  long_help.push_back("--help");
  version.push_back("-V");
  const Result helped = orchard(help);
  EXPECT_EQ(helped.exit_code, 0) << helped.err;
  EXPECT_EQ(helped.out, orchard(long_help).out);
  // The words of the library that reads the command line stay inside.
  for (const char* inner : {"->", "ENUM", "FLOAT", "UINT", "INT:", "NONNEGATIVE", "POSITIVE",
                            "REQUIRED", "Excludes:", "Needs:", "SUBCOMMAND", " OR {"}) {
    EXPECT_THAT(helped.out, ::testing::Not(HasSubstr(inner)));
  }
  EXPECT_THAT(orchard(version).out, HasSubstr("orchard 0."));
  int num = 1;
  for (const std::string& name : commands_in(helped.out)) {
    if (name == "help") continue;
    std::vector<std::string> below(command);
    below.push_back(name);
    num += check_help(below);
  }
  if (num > 1) return num;
  std::string words = "orchard";
  for (const std::string& word : command) words += " " + word;
  EXPECT_THAT(helped.out, HasSubstr("Example")) << words;
  EXPECT_THAT(helped.out, HasSubstr(words));
  return num;
}

TEST(CommandLine, EveryCommandKnowsHelpWithExamplesAndVersion) {
  EXPECT_GT(check_help({}), 50);
  EXPECT_EQ(orchard({"help", "mpa"}).exit_code, 2);
  for (const char* process : {"orchard-sim-driver", "orchard-log-player"}) {
    EXPECT_THAT(run({std::string(ORCHARD_BUILD_DIR "/bin/") + process, "-V"}).out,
                HasSubstr(std::string(process) + " 0."));
  }
}

TEST(CommandLine, TheSimDriverSaysHowLongItTakes) {
  const Result result = run({ORCHARD_BUILD_DIR "/bin/orchard-sim-driver", "--scene", "tubes",
                             "--lcm-url", "memq://", "--speed", "100"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("publishing 18 s of messages at speed 100, which takes 1 s"));
  EXPECT_THAT(result.err, ::testing::Not(HasSubstr("%")));  // no bar where no person watches
}

TEST(CommandLine, AnglesAreInRadians) {
  for (const char* command : {"map", "compare", "merge"}) {
    const std::string help = orchard({"help", command}).out;
    EXPECT_THAT(help, HasSubstr("--max-turn-rad"));
    EXPECT_THAT(help, ::testing::Not(HasSubstr("[degrees]")));
  }
  // The name of the last release.
  const Result old = orchard({"compare", "a", "b", "--max-turn", "10"});
  EXPECT_EQ(old.exit_code, 2);
  EXPECT_THAT(old.err, HasSubstr("did you mean --max-turn-rad?"));
}

TEST(CommandLine, MisspeltWordsGetASuggestion) {
  EXPECT_EQ(orchard({"mpa"}).exit_code, 2);
  EXPECT_THAT(orchard({"mpa"}).err, HasSubstr("did you mean map?"));
  EXPECT_THAT(orchard({"evalaute", "x"}).err, HasSubstr("did you mean evaluate?"));
  EXPECT_THAT(orchard({"log", "inof", "x"}).err, HasSubstr("did you mean info?"));
  const Result option = orchard({"map", "x.lcm", "--confg", "y.yaml", "--out", "z"});
  EXPECT_EQ(option.exit_code, 2);
  EXPECT_THAT(option.err, HasSubstr("did you mean --config?"));
}

TEST(CommandLine, FarFetchedWordsGetNone) {
  const Result result = orchard({"xylophone"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, ::testing::Not(HasSubstr("did you mean")));
}

TEST(CommandLine, WhatIsMissingIsNamed) {
  EXPECT_EQ(orchard({}).exit_code, 2);
  EXPECT_EQ(orchard({"log"}).exit_code, 2);
  const Result result = orchard({"map", "x.lcm"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("--out"));
}

TEST(CommandLine, UnknownSceneIsABadCommandLine) {
  const Result result = orchard({"simulate", "--scene", "moon", "--out", "/nonexistent/x"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("tubes"));
}

class MapCommand : public CliTest {};

TEST_F(MapCommand, WritesTheWholeFolderAndSaysWhatItFound) {
  const Result result = map(log());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  for (const char* file :
       {"map.csv", "map.gpkg", "map.svg", "map.png", "map.pdf", "map.html", "trajectory.csv",
        "trajectory.tum", "graph.json", "summary.json", "derived.lcm", "album"}) {
    EXPECT_TRUE(exists(path("map/") + file)) << file;
    EXPECT_THAT(result.out, HasSubstr(file));
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(path("map")), {}), 12);
  EXPECT_EQ(orchard({"log", "check", path("map/derived.lcm")}).exit_code, 0);
  EXPECT_THAT(result.out, HasSubstr("16 landmarks: 12 trees in rows, 4 objects"));
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

TEST_F(MapCommand, TheMessagesOnTheWayCanBeLeftOut) {
  ASSERT_EQ(map(log()).exit_code, 0);
  const std::string csv = read_file(path("map/map.csv"));
  const Result result = map(log(), {"--no-derived"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_FALSE(exists(path("map/derived.lcm")));  // nor that of the map before
  EXPECT_THAT(result.out, ::testing::Not(HasSubstr("derived.lcm")));
  EXPECT_EQ(read_file(path("map/map.csv")), csv);
}

TEST_F(MapCommand, ALogWithoutARigIsMappedByWhatItShowsOfIt) {
  {
    io::LogReader reader(log());
    io::LogWriter writer(path("bare.lcm"));
    while (const auto event = reader.next()) {
      if (event->channel == "CONFIG") continue;
      writer.write(event->timestamp_us, event->channel, event->data);
    }
    writer.close();
  }
  const Result result = orchard({"map", path("bare.lcm"), "--out", path("bare")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("16 landmarks"));
  EXPECT_THAT(result.err, HasSubstr("it was learnt from the drive"));
  EXPECT_THAT(result.err, HasSubstr("not seen: laser.mount_x_m"));
  const Result learnt = orchard({"learn", path("bare.lcm"), "--out", path("rig.yaml")});
  ASSERT_EQ(learnt.exit_code, 0) << learnt.err;
  EXPECT_THAT(learnt.out, HasSubstr("detector.width.mean_m: 0.09"));  // the tubes' is 0.09
  EXPECT_EQ(read_file(path("rig.yaml")), read_file(path("bare/learnt.yaml")));
  ASSERT_EQ(orchard({"map", path("bare.lcm"), "--config", path("rig.yaml"), "--out", path("again")})
                .exit_code,
            0);
  EXPECT_EQ(read_file(path("again/map.csv")), read_file(path("bare/map.csv")));

  // What is given and not seen stays.
  write_file(path("facts.yaml"),
             "laser:\n  range_sd_m: 0.004\ncamera:\n  enabled: false\npose:\n  mode: fixes\n"
             "mapper:\n  min_observations: 7\n");
  ASSERT_EQ(orchard({"learn", path("bare.lcm"), "--config", path("facts.yaml"), "--out",
                     path("more.yaml")})
                .exit_code,
            0);
  for (const char* fact :
       {"range_sd_m: 0.004", "mode: fixes", "min_observations: 7", "mean_m: 0.09"}) {
    EXPECT_THAT(read_file(path("more.yaml")), HasSubstr(fact));
  }

  const Result nothing = orchard({"learn", path("rig.yaml"), "--out", path("none.yaml")});
  EXPECT_EQ(nothing.exit_code, 3) << nothing.err;
  EXPECT_FALSE(exists(path("none.yaml")));
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
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (!exists(path("map/derived.lcm.part")) && std::chrono::steady_clock::now() < give_up) {
    usleep(1000);  // between two looks
  }
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

TEST_F(MapCommand, SimulationStopsAfterTheDuration) {
  const Result result = orchard({"simulate", "--scene", "orchard", "--seed", "1", "--out",
                                 path("short.lcm"), "--poses", path("poses.csv"), "--duration",
                                 "1.5", "--config", ORCHARD_SOURCE_DIR "/config/orchard.yaml"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(num_messages(path("short.lcm"), "SCAN"), 16);      // 10 Hz from 0 to 1.5 s
  EXPECT_EQ(num_messages(path("short.lcm"), "ODOMETRY"), 76);  // 50 Hz
  EXPECT_EQ(count_lines(read_file(path("poses.csv"))), 17);    // a header, and one per scan
}

TEST_F(MapCommand, SimulatedHillsHaveHeights) {
  const Result result =
      orchard({"simulate", "--scene", "orchard", "--seed", "1", "--out", path("hills.lcm"),
               "--truth", path("truth.csv"), "--poses", path("poses.csv"), "--duration", "1",
               "--config", ORCHARD_SOURCE_DIR "/config/hills.yaml"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(read_file(path("truth.csv")), HasSubstr("class,x_m,y_m,width_m,z_m\ntree,"));
  EXPECT_THAT(read_file(path("poses.csv")),
              HasSubstr("utime_us,x_m,y_m,yaw_rad,z_m,roll_rad,pitch_rad\n"));
  EXPECT_EQ(num_messages(path("hills.lcm"), "IMU"), 101);
}

class Overlay : public CliTest {
 protected:
  Result overlay(const std::string& log_path, const std::string& at) const {
    return orchard(
        {"overlay", log_path, "--at", at, "--config", config(), "--out", path("overlay.png")});
  }
  void expect_refused(const Result& result, const std::string& why) const {
    EXPECT_EQ(result.exit_code, 3) << result.out;
    EXPECT_THAT(result.err, HasSubstr(why));
    EXPECT_LE(count_lines(result.err), 3) << result.err;  // at most with the key that differs
    EXPECT_FALSE(exists(path("overlay.png")));
  }
};

TEST_F(Overlay, DrawsThePairNearestToATime) {
  const Result result = overlay(log(), "3.4");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const cv::Mat drawn = cv::imread(path("overlay.png"));
  ASSERT_EQ(drawn.cols, 1280);  // 320 pixels four times
  EXPECT_GT(drawn.rows, 960);
  const std::string bytes = read_file(path("overlay.png"));
  // Stops are a second apart, so the third is meant; the same by its utime.
  ASSERT_EQ(overlay(log(), "1385942403000000").exit_code, 0);
  EXPECT_EQ(read_file(path("overlay.png")), bytes);
  ASSERT_EQ(overlay(log(), "5").exit_code, 0);
  EXPECT_NE(read_file(path("overlay.png")), bytes);
}

TEST_F(Overlay, SaysWhatIsWrong) {
  expect_refused(overlay(log(), "9999"), "give --at within it");
  expect_refused(overlay(log(), "-1"), "give --at within it");
  expect_refused(overlay(path("none.lcm"), "1"), "none.lcm");
  write_file(path("empty.lcm"), "");
  expect_refused(overlay(path("empty.lcm"), "1"), "empty.lcm");
  EXPECT_EQ(overlay(log(), "soon").exit_code, 2);

  io::LogWriter blind(path("blind.lcm")), early(path("early.lcm"));
  io::LogReader reader(log());
  int num_images = 0;
  while (const auto event = reader.next()) {
    const bool is_image = event->channel == bus::info(bus::Channel::kImage).name;
    if (!is_image) blind.write(event->timestamp_us, event->channel, event->data);
    if (is_image && ++num_images > 2) continue;
    early.write(event->timestamp_us, event->channel, event->data);
  }
  blind.close();
  early.close();
  expect_refused(overlay(path("blind.lcm"), "1"), "IMAGE");
  expect_refused(overlay(path("early.lcm"), "9"), "no pair of scan and picture");
}

TEST_F(Overlay, WithoutACameraTheScanIsDrawnFromAbove) {
  std::string rig = read_file(config());
  const std::size_t at = rig.find("enabled: true", rig.find("camera:"));
  ASSERT_NE(at, std::string::npos);
  rig.replace(at, 13, "enabled: false");
  write_file(path("laser.yaml"), rig);
  const Result result = orchard({"overlay", log(), "--at", "3.4", "--config", path("laser.yaml"),
                                 "--out", path("overlay.png")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("the scan from above"));
  EXPECT_GT(cv::imread(path("overlay.png")).cols, 900);
}

TEST_F(Overlay, ARigOfAnotherCameraIsRefused) {
  std::string rig = read_file(config());
  const std::size_t at = rig.find("width_px: 320");
  ASSERT_NE(at, std::string::npos);
  rig.replace(at, 13, "width_px: 640");
  write_file(path("rig.yaml"), rig);
  expect_refused(orchard({"overlay", log(), "--at", "3", "--config", path("rig.yaml"), "--out",
                          path("overlay.png")}),
                 "320x240");
}

TEST_F(Overlay, ADelayNeedsADriveThatTurns) {
  const std::string before = read_file(config());
  const auto calibrate = [&](const std::string& log_path, const std::string& rig) {
    return orchard({"calibrate", "delay", log_path, "--config", rig, "--out", path("rig.yaml")});
  };
  const Result standing = calibrate(log(), config());
  EXPECT_EQ(standing.exit_code, 3);
  EXPECT_THAT(standing.err, HasSubstr("ODOMETRY"));
  EXPECT_EQ(count_lines(standing.err), 1) << standing.err;

  const std::string orchard_rig = ORCHARD_SOURCE_DIR "/config/orchard.yaml";
  ASSERT_EQ(orchard({"simulate", "--scene", "orchard", "--seed", "6", "--config", orchard_rig,
                     "--out", path("straight.lcm"), "--duration", "8"})
                .exit_code,
            0);
  const Result straight = calibrate(path("straight.lcm"), orchard_rig);
  EXPECT_EQ(straight.exit_code, 3);
  EXPECT_THAT(straight.err, HasSubstr("hardly turned"));
  EXPECT_EQ(count_lines(straight.err), 1) << straight.err;

  EXPECT_EQ(calibrate(path("none.lcm"), orchard_rig).exit_code, 3);
  EXPECT_FALSE(exists(path("rig.yaml")));
  EXPECT_EQ(read_file(config()), before);
}

}  // namespace

}  // namespace orchard::cli_test
