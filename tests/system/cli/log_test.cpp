// SPDX-License-Identifier: BSD-3-Clause
// A scene has a rig of its own, a log carries it, and `orchard map` maps by it.
#include <gmock/gmock.h>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "bus/messages/channel.hpp"
#include "bus/messages/codec.hpp"
#include "bus/messages/service_messages.hpp"
#include "io/config/config_file.hpp"
#include "io/log/log_reader.hpp"
#include "io/log/log_writer.hpp"
#include "system/cli/cli_fixture.hpp"

namespace orchard::cli_test {
namespace {

using ::testing::HasSubstr;

class LogCommand : public CliTest {
 protected:
  /// The drive's log without its middle 1000 bytes.
  void write_damaged() const {
    std::string bytes = read_file(log());
    bytes.erase(bytes.size() / 2, 1000);
    write_file(path("damaged.lcm"), bytes);
  }
};

TEST_F(LogCommand, InfoShowsWhatItHolds) {
  const Result result = orchard({"log", "info", log()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, ::testing::ContainsRegex("SCAN +scan_t +source "));
  // One pair and one position per step.
  EXPECT_GE(num_messages(log(), "SCAN"), 18);
  EXPECT_EQ(num_messages(log(), "IMAGE"), num_messages(log(), "SCAN"));
  EXPECT_EQ(num_messages(log(), "POSE_FIX"), num_messages(log(), "SCAN"));
}

TEST_F(LogCommand, JsonSaysTheSame) {
  const Result result = orchard({"log", "info", log(), "--json"});
  EXPECT_EQ(result.exit_code, 0);
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json.at("sound"), true);
  EXPECT_EQ(json.at("channels").size(), 4u);
  long num = 0;
  for (const auto& channel : json.at("channels")) {
    EXPECT_EQ(channel.at("num_messages"), num_messages(log(), channel.at("channel")));
    num += channel.at("num_messages").get<long>();
  }
  EXPECT_EQ(json.at("num_messages"), num);
  write_damaged();
  const Result damaged = orchard({"log", "check", path("damaged.lcm"), "--json"});
  EXPECT_EQ(damaged.exit_code, 3);
  EXPECT_EQ(nlohmann::json::parse(damaged.out).at("sound"), false);
  EXPECT_GE(nlohmann::json::parse(damaged.out).at("gaps").size(), 1u);
}

TEST_F(LogCommand, CheckPassesASoundLog) {
  const Result result = orchard({"log", "check", log()});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, HasSubstr("sound"));
}

TEST_F(LogCommand, CheckSaysWhereTheDamageIs) {
  write_damaged();
  const Result result = orchard({"log", "check", path("damaged.lcm")});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.out, HasSubstr("at offset"));
}

TEST_F(LogCommand, RepairKeepsWhatCanBeUsed) {
  write_damaged();
  const Result repair =
      orchard({"log", "repair", path("damaged.lcm"), "--out", path("repaired.lcm")});
  EXPECT_EQ(repair.exit_code, 0) << repair.err;
  EXPECT_THAT(repair.out, HasSubstr("recovered"));
  EXPECT_GE(num_messages(path("repaired.lcm"), "SCAN"), num_messages(log(), "SCAN") - 1);
  EXPECT_EQ(orchard({"log", "check", path("repaired.lcm")}).exit_code, 0);
  EXPECT_EQ(map(path("damaged.lcm"), {"--strict"}).exit_code, 3);
  EXPECT_EQ(map(path("repaired.lcm"), {"--strict"}).exit_code, 0);
}

TEST_F(LogCommand, RepairNeverWritesOverItsInput) {
  write_damaged();
  const std::string before = read_file(path("damaged.lcm"));
  const Result result =
      orchard({"log", "repair", path("damaged.lcm"), "--out", path("./damaged.lcm")});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_TRUE(read_file(path("damaged.lcm")) == before);
}

TEST_F(LogCommand, WhatIsNoLogIsRefused) {
  write_file(path("empty.lcm"), "");
  write_file(path("text.lcm"), "this is not a log\n");
  for (const char* command : {"info", "check"}) {
    for (const char* name : {"empty.lcm", "text.lcm", "none.lcm"}) {
      const Result result = orchard({"log", command, path(name)});
      EXPECT_EQ(result.exit_code, 3) << command << " " << name;
      EXPECT_THAT(result.err, HasSubstr(name));
      EXPECT_EQ(count_lines(result.err), 1) << result.err;
    }
  }
  EXPECT_EQ(orchard({"log", "repair", path("text.lcm"), "--out", path("repaired.lcm")}).exit_code,
            3);
  EXPECT_FALSE(exists(path("repaired.lcm")));
}

class BadInput : public CliTest {
 protected:
  /// One clear sentence that names the file, exit code 3, and no map.
  void expect_refused(const std::string& log_path) const {
    const Result result = map(log_path);
    EXPECT_EQ(result.exit_code, 3) << log_path << "\n" << result.out;
    EXPECT_THAT(result.err, HasSubstr(std::filesystem::path(log_path).filename().string()));
    EXPECT_EQ(count_lines(result.err), 1) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_FALSE(exists(path("map/map.csv")));
    EXPECT_FALSE(exists(path("map/derived.lcm")));
  }
};

TEST_F(BadInput, WhatIsNoLogIsRefused) {
  expect_refused(path("none.lcm"));
  expect_refused(std::filesystem::path(path("x")).parent_path());
  write_file(path("empty.lcm"), "");
  expect_refused(path("empty.lcm"));
  write_file(path("text.lcm"), std::string(5000, 'x'));
  expect_refused(path("text.lcm"));
  io::LogWriter writer(path("other.lcm"));
  for (int i = 0; i < 20; ++i) writer.write(i, "CAMERA_LEFT", {1, 2, 3});
  writer.close();
  expect_refused(path("other.lcm"));
}

TEST_F(BadInput, ALogWithoutScansOrPositionsIsRefused) {
  for (const bus::Channel missing : {bus::Channel::kScan, bus::Channel::kPoseFix}) {
    io::LogReader reader(log());
    io::LogWriter writer(path("partial.lcm"));
    while (const auto event = reader.next()) {
      if (event->channel == bus::info(missing).name) continue;
      writer.write(event->timestamp_us, event->channel, event->data);
    }
    writer.close();
    expect_refused(path("partial.lcm"));
  }
}

TEST_F(BadInput, AFailedRunLeavesTheLastMap) {
  ASSERT_EQ(map(log()).exit_code, 0);
  const std::string before = read_file(path("map/map.csv"));
  write_file(path("empty.lcm"), "");
  EXPECT_EQ(map(path("empty.lcm")).exit_code, 3);
  EXPECT_EQ(read_file(path("map/map.csv")), before);
}

TEST_F(BadInput, OutputThatCannotBeWritten) {
  write_file(path("map"), "a file where the folder should be");
  const Result result = map(log());
  EXPECT_EQ(result.exit_code, 1) << "not of what the input holds";
  EXPECT_EQ(count_lines(result.err), 1) << result.err;
}

using ::testing::Not;

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

class LoggedRig : public CliTest {
 protected:
  /// The drive's log with these CONFIG messages in place of its own.
  void write_log(const std::string& name, const std::vector<bus::ConfigNotice>& notices) const {
    const std::string channel(bus::info(bus::Channel::kConfig).name);
    io::LogReader reader(log());
    io::LogWriter writer(path(name));
    for (const bus::ConfigNotice& notice : notices) writer.write(1, channel, bus::encode(notice));
    while (const auto event = reader.next()) {
      if (event->channel != channel) writer.write(event->timestamp_us, event->channel, event->data);
    }
    writer.close();
  }

  static bus::ConfigNotice notice(const std::string& process, const std::string& yaml) {
    bus::ConfigNotice notice;
    notice.name = process;
    notice.version = "0.0";
    notice.text = yaml;
    notice.hash = io::text_hash(yaml);
    return notice;
  }

  static std::string rig_of_log() { return orchard({"log", "config", log()}).out; }
};

TEST_F(LoggedRig, ASceneIsDrivenWithTheRigOfItsName) {
  for (const std::string scene : {"tubes", "orchard"}) {
    std::vector<std::string> drive{"simulate", "--scene", scene, "--duration", "2", "--out"};
    drive.push_back(path("own.lcm"));
    ASSERT_EQ(orchard(drive).exit_code, 0);
    drive.back() = path("given.lcm");
    drive.insert(drive.end(), {"--config", ORCHARD_SOURCE_DIR "/config/" + scene + ".yaml"});
    ASSERT_EQ(orchard(drive).exit_code, 0);
    EXPECT_TRUE(read_file(path("own.lcm")) == read_file(path("given.lcm"))) << scene;
  }
}

TEST_F(LoggedRig, MapsByTheLogsOwnRig) {
  ASSERT_EQ(orchard({"map", log(), "--out", path("own")}).exit_code, 0);
  const Result given = map(log());
  ASSERT_EQ(given.exit_code, 0);
  EXPECT_EQ(given.err, "");
  for (const char* file : {"map.csv", "derived.lcm", "summary.json"}) {
    EXPECT_TRUE(read_file(path("own/") + file) == read_file(path("map/") + file)) << file;
  }
}

TEST_F(LoggedRig, IsPrintedAsAFileThatConfigReads) {
  const Result printed = orchard({"log", "config", log()});
  ASSERT_EQ(printed.exit_code, 0) << printed.err;
  write_file(path("printed.yaml"), printed.out);
  const Result mapped =
      orchard({"map", log(), "--config", path("printed.yaml"), "--out", path("map")});
  EXPECT_EQ(mapped.exit_code, 0);
  EXPECT_EQ(mapped.err, "");
}

TEST_F(LoggedRig, AnotherRigSaysWhatDiffersBeforeItMaps) {
  std::string other = replaced(rig_of_log(), "tree_threshold: 0.6", "tree_threshold: 0.55");
  other = replaced(other, "hue_max_deg: 40", "hue_max_deg: 41");
  other = replaced(other, "num_steps: 19", "num_steps: 18");  // of the simulated world: no matter
  write_file(path("other.yaml"), other);
  const Result result =
      orchard({"map", log(), "--config", path("other.yaml"), "--out", path("map"), "--quiet"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.err, HasSubstr("detector.tree_threshold: 0.6 -> 0.55"));
  EXPECT_THAT(result.err, HasSubstr("detector.colour.hue_max_deg: 40 -> 41"));
  EXPECT_EQ(count_lines(result.err), 3) << result.err;
  // What differs is said even when mapping fails at once.
  write_file(path("file"), "");
  EXPECT_THAT(orchard({"map", log(), "--config", path("other.yaml"), "--out", path("file")}).err,
              HasSubstr("0.6 -> 0.55"));
}

TEST_F(LoggedRig, IsAskedForWhereTheLogHasNone) {
  write_log("bare.lcm", {});
  const Result result = orchard({"log", "config", path("bare.lcm")});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("--config FILE"));
  EXPECT_THAT(result.err, HasSubstr("bare.lcm"));
  EXPECT_EQ(map(path("bare.lcm")).exit_code, 0);
}

TEST_F(LoggedRig, AContradictedHashIsNoRig) {
  bus::ConfigNotice damaged = notice("orchard-detector", rig_of_log());
  damaged.text = replaced(damaged.text, "tree_threshold: 0.6", "tree_threshold: 0.7");
  write_log("damaged.lcm", {damaged});
  EXPECT_EQ(orchard({"map", path("damaged.lcm"), "--out", path("map")}).exit_code, 3);
}

TEST_F(LoggedRig, ProcessesThatDisagreeAreNamed) {
  const std::string rig = rig_of_log();
  const std::string other = replaced(rig, "tree_threshold: 0.6", "tree_threshold: 0.7");
  const std::string elsewhere = replaced(rig, "udpm://239.255.76.67", "udpm://239.255.76.68");
  write_log("two.lcm", {notice("orchard-sim-driver", rig), notice("orchard-detector", other)});
  write_log("same.lcm", {notice("orchard-sim-driver", rig), notice("orchard-pose", elsewhere)});
  const Result result = orchard({"map", path("two.lcm"), "--out", path("map")});
  EXPECT_EQ(result.exit_code, 3);
  for (const char* word : {"orchard-sim-driver", "orchard-detector", "--config",
                           "detector.tree_threshold: 0.6 -> 0.7"}) {
    EXPECT_THAT(result.err, HasSubstr(word));
  }
  EXPECT_EQ(orchard({"log", "config", path("two.lcm")}).exit_code, 3);
  const Result one = orchard({"log", "config", path("two.lcm"), "--process", "orchard-detector"});
  EXPECT_EQ(one.exit_code, 0);
  EXPECT_THAT(one.out, HasSubstr("tree_threshold: 0.7"));
  EXPECT_EQ(orchard({"log", "config", path("two.lcm"), "--process", "orchard-x"}).exit_code, 3);
  // Another network is no other rig.
  EXPECT_EQ(orchard({"map", path("same.lcm"), "--out", path("map")}).exit_code, 0);
  // A given rig that is one of the two needs no word.
  write_file(path("other.yaml"), other);
  EXPECT_EQ(
      orchard({"map", path("two.lcm"), "--config", path("other.yaml"), "--out", path("map")}).err,
      "");
}

TEST_F(LoggedRig, ARigOfANewerReleaseIsNotGuessed) {
  bus::ConfigNotice newer = notice("orchard-detector", "detector:\n  cleverness: 11\n");
  newer.version = "99.10.0";
  write_log("newer.lcm", {newer});
  const Result result = orchard({"map", path("newer.lcm"), "--out", path("map")});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("cleverness: unknown key"));
  EXPECT_THAT(result.err, HasSubstr("--config FILE"));
  EXPECT_THAT(map(path("newer.lcm")).err, HasSubstr("detector.cleverness: 11 -> (none)"));
}

TEST_F(LoggedRig, AnOlderReleaseMayHaveKeysThatWentAndSaysSo) {
  write_log("older.lcm", {notice("orchard-detector", "detector:\n  cleverness: 11\n")});
  const Result result = orchard({"map", path("older.lcm"), "--out", path("map")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("detector.cleverness = 11 is no key of this version"));
}

}  // namespace

}  // namespace orchard::cli_test
