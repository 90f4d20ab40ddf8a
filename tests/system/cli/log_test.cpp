// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

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

}  // namespace
}  // namespace orchard::cli_test
