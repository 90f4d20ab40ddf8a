// SPDX-License-Identifier: BSD-3-Clause
// A scene has a rig of its own, a log carries it, and `orchard map` maps by it.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "bus/messages/channel.hpp"
#include "bus/messages/service_messages.hpp"
#include "io/config/config_file.hpp"
#include "io/log/log_reader.hpp"
#include "io/log/log_writer.hpp"
#include "system/cli/cli_fixture.hpp"

namespace orchard::cli_test {
namespace {

using ::testing::HasSubstr;
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

TEST_F(LoggedRig, TheFirstTourFindsEverything) {
  const std::string drive = path("out/tubes.lcm"), truth = path("out/truth.csv");
  ASSERT_EQ(orchard({"simulate", "--scene", "tubes", "--out", drive, "--truth", truth}).exit_code,
            0);
  const Result mapped = orchard({"map", drive, "--out", path("out/tubes")});
  ASSERT_EQ(mapped.exit_code, 0) << mapped.err;
  EXPECT_EQ(mapped.err, "");
  const Result result =
      orchard({"evaluate", path("out/tubes"), "--truth", truth, "--json", "--check"});
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_LT(json.at("error_all").at("rms_m").get<double>(), 0.008) << result.out;
}

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
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"map", path("bare.lcm"), "--out", path("map")},
        std::vector<std::string>{"log", "config", path("bare.lcm")}}) {
    const Result result = orchard(command);
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_THAT(result.err, HasSubstr("--config FILE"));
    EXPECT_THAT(result.err, HasSubstr("bare.lcm"));
  }
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
