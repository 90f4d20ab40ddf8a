// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "bus/messages/codec.hpp"
#include "io/log/log_reader.hpp"
#include "io/log/log_writer.hpp"
#include "system/cli/cli_fixture.hpp"

namespace orchard::cli_test {
namespace {

using ::testing::HasSubstr;

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

  /// The number behind a key of summary.json's counts.
  long summary_count(const std::string& key) const {
    const auto summary = nlohmann::json::parse(read_file(path("map/summary.json")));
    const auto& counts = summary["counts"];
    if (counts.contains(key)) return counts[key].get<long>();
    ADD_FAILURE() << "summary.json has no " << key;
    return -1;
  }
};

TEST_F(BadInput, NoSuchLog) { expect_refused(path("none.lcm")); }

TEST_F(BadInput, AFolderIsNoLog) { expect_refused(std::filesystem::path(path("x")).parent_path()); }

TEST_F(BadInput, EmptyLog) {
  write_file(path("empty.lcm"), "");
  expect_refused(path("empty.lcm"));
}

TEST_F(BadInput, NotALog) {
  write_file(path("text.lcm"), std::string(5000, 'x'));
  expect_refused(path("text.lcm"));
}

TEST_F(BadInput, NoChannelThatWeKnow) {
  io::LogWriter writer(path("other.lcm"));
  for (int i = 0; i < 20; ++i) writer.write(i, "CAMERA_LEFT", {1, 2, 3});
  writer.close();
  expect_refused(path("other.lcm"));
}

TEST_F(BadInput, NoScan) {
  io::LogReader reader(log());
  io::LogWriter writer(path("blind.lcm"));
  while (const auto event = reader.next()) {
    if (event->channel != bus::info(bus::Channel::kScan).name) {
      writer.write(event->timestamp_us, event->channel, event->data);
    }
  }
  writer.close();
  expect_refused(path("blind.lcm"));
}

TEST_F(BadInput, NothingSaysWhereTheRobotWas) {
  io::LogReader reader(log());
  io::LogWriter writer(path("lost.lcm"));
  while (const auto event = reader.next()) {
    if (event->channel != bus::info(bus::Channel::kPoseFix).name) {
      writer.write(event->timestamp_us, event->channel, event->data);
    }
  }
  writer.close();
  expect_refused(path("lost.lcm"));
}

TEST_F(BadInput, ALogCutShortIsMappedAsFarAsItGoes) {
  const std::string bytes = read_file(log());
  write_file(path("cut.lcm"), bytes.substr(0, bytes.size() * 7 / 10 + 11));
  const Result result = map(path("cut.lcm"));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("warning"));
  EXPECT_TRUE(exists(path("map/map.csv")));
  EXPECT_GT(summary_count("damaged_bytes"), 0);
  std::filesystem::remove_all(path("map"));
  const Result strict = map(path("cut.lcm"), {"--strict"});
  EXPECT_EQ(strict.exit_code, 3);
  EXPECT_EQ(count_lines(strict.err), 1) << strict.err;
  EXPECT_FALSE(exists(path("map/map.csv")));
}

TEST_F(BadInput, DamageInTheMiddleCostsOnlyWhatItHit) {
  std::string bytes = read_file(log());
  bytes.replace(bytes.size() / 3, 600, std::string(600, '\xff'));
  write_file(path("damaged.lcm"), bytes);
  const Result result = map(path("damaged.lcm"));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(exists(path("map/map.csv")));
  // 600 bytes touch at most two messages.
  const long num_all = num_messages(log(), "SCAN") * 3 + 1;  // scan, picture and fix; the rig once
  EXPECT_GE(summary_count("events"), num_all - 2);
  EXPECT_LT(summary_count("events"), num_all + 1);
}

TEST_F(BadInput, AMessageThatContradictsItselfIsCountedAndDropped) {
  io::LogReader reader(log());
  io::LogWriter writer(path("contradiction.lcm"));
  bool broken = false;
  while (auto event = reader.next()) {
    if (!broken && event->channel == bus::info(bus::Channel::kScan).name) {
      event->data.resize(event->data.size() - 40);  // fewer ranges than it says
      broken = true;
    }
    writer.write(event->timestamp_us, event->channel, event->data);
  }
  writer.close();
  const Result result = map(path("contradiction.lcm"));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("warning"));
  EXPECT_EQ(summary_count("in_SCAN"), num_messages(log(), "SCAN") - 1);
  EXPECT_EQ(map(path("contradiction.lcm"), {"--strict"}).exit_code, 3);
  EXPECT_EQ(orchard({"log", "check", path("contradiction.lcm")}).exit_code, 3);
}

TEST_F(BadInput, ThreeMistakesInAConfigurationAreAllNamed) {
  write_file(path("rig.yaml"),
             "detector:\n"
             "  tree_threshold: 1.9\n"
             "  colour_modle: appearance\n"
             "mapper:\n"
             "  gate_m: near\n");
  const Result result = orchard({"map", log(), "--config", path("rig.yaml"), "--out", path("map")});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("rig.yaml:2: detector.tree_threshold = 1.9"));
  EXPECT_THAT(result.err, HasSubstr("rig.yaml:3: detector.colour_modle"));
  EXPECT_THAT(result.err, HasSubstr("did you mean colour_model?"));
  EXPECT_THAT(result.err, HasSubstr("rig.yaml:5: mapper.gate_m = near"));
  EXPECT_EQ(count_lines(result.err), 3) << result.err;
  EXPECT_FALSE(exists(path("map")));
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
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_EQ(count_lines(result.err), 1) << result.err;
}

TEST_F(BadInput, AFullDiskLeavesTheLastGoodMap) {
  // A disk of our own that is full: a tmpfs in a private mount namespace.
  const std::string script = path("full_disk.sh");
  write_file(script,
             "set -e\n"
             "folder=$1; tool=$2; log=$3; config=$4; other=$5\n"
             "mkdir $folder/disk\n"
             "mount -t tmpfs -o size=8m tmpfs $folder/disk || exit 77\n"
             "$tool map $log --config $config --out $folder/disk/map --quiet\n"
             "all() { find $folder/disk/map -type f -print0 | sort -z | xargs -0 sha256sum; }\n"
             "before=$(all)\n"
             "cat /dev/zero >$folder/disk/ballast 2>/dev/null || true\n"
             "code=0\n"
             "$tool map $other --config $config --out $folder/disk/map --quiet || code=$?\n"
             "[ \"$before\" = \"$(all)\" ] || exit 78\n"
             "exit $code\n");
  const std::string other = path("other.lcm");
  ASSERT_EQ(
      orchard({"simulate", "--scene", "tubes", "--seed", "4", "--out", other, "--config", config()})
          .exit_code,
      0);
  const std::string folder = std::filesystem::path(script).parent_path();
  const Result result = run({"unshare", "-rm", "bash", script, folder,
                             ORCHARD_BUILD_DIR "/bin/orchard", log(), config(), other});
  if (result.exit_code == 77 || result.err.find("unshare") != std::string::npos) {
    GTEST_SKIP() << "no mount namespace is allowed here: " << result.err;
  }
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_THAT(result.err, HasSubstr("map"));
  EXPECT_EQ(count_lines(result.err), 1) << result.err;
}

}  // namespace
}  // namespace orchard::cli_test
