// SPDX-License-Identifier: BSD-3-Clause
#include "cli/field/status_board.hpp"

#include <nlohmann/json.hpp>

namespace orchard::cli {
namespace {

constexpr std::int64_t kNow = 1'700'000'000'000'000;
constexpr std::int64_t kSecond = 1'000'000;

bus::Status status_of(const std::string& name, const std::string& host, std::int32_t seq,
                      std::int64_t utime) {
  bus::Status status;
  status.name = name;
  status.host = host;
  status.seq = seq;
  status.utime = utime;
  return status;
}

TEST(StatusBoard, ShowsTheLastWordOfEachProcessOfEachHost) {
  StatusBoard board;
  board.note(status_of("orchard-pose", "b", 0, kNow), kNow);
  board.note(status_of("orchard-pose", "a", 0, kNow), kNow);
  bus::Status second = status_of("orchard-pose", "a", 1, kNow + kSecond);
  second.num_lost = 7;
  second.input_period_s = 0.02;
  board.note(second, kNow + kSecond);
  const auto processes = board.processes(kNow + kSecond);
  ASSERT_EQ(processes.size(), 2u);
  EXPECT_EQ(processes[0].status.host, "a");
  EXPECT_EQ(processes[0].num_new_lost, 7);
  EXPECT_DOUBLE_EQ(processes[0].input_hz, 50.0);
  EXPECT_DOUBLE_EQ(processes[1].age_s, 1.0);
}

TEST(StatusBoard, ASilentProcessIsSaidToBeAndForgottenAfterAMinute) {
  StatusBoard board;
  board.note(status_of("orchard-pose", "a", 0, kNow), kNow);
  EXPECT_EQ(state_word(board.processes(kNow + 2 * kSecond)[0]), "ok");
  EXPECT_EQ(state_word(board.processes(kNow + 3 * kSecond)[0]), "silent");
  EXPECT_TRUE(needs_attention(board.processes(kNow + 3 * kSecond)[0]));
  EXPECT_TRUE(board.processes(kNow + 61 * kSecond).empty());
}

TEST(StatusBoard, ClocksThatAreApartAreNamedAndSlowMessagesAreNot) {
  StatusBoard board;
  // Host b is 200 ms behind; its messages take 1 to 90 ms. Host a is right, with the same delays.
  for (int i = 0; i < 8; ++i) {
    const std::int64_t sent = kNow + i * kSecond;
    const std::int64_t delay_us = i == 5 ? 1000 : 90000;
    board.note(status_of("orchard-detector", "a", i, sent), sent + delay_us);
    board.note(status_of("orchard-pose", "b", i, sent - 200000), sent + delay_us);
  }
  const auto processes = board.processes(kNow + 7 * kSecond);
  EXPECT_NEAR(processes[0].clock_offset_s, 0.0, 0.0011);
  EXPECT_NEAR(processes[1].clock_offset_s, -0.2, 0.0011);
  const std::string table = status_table(processes, 0, false);
  EXPECT_NE(table.find("its clock is 0.201 s behind"), std::string::npos) << table;
  EXPECT_EQ(table.find("ahead"), std::string::npos);
}

TEST(StatusBoard, AProcessOfThisMachineHasItsClock) {
  StatusBoard board("a");
  board.note(status_of("orchard-detector", "a:17", 0, kNow), kNow + 23'000);  // a busy machine
  EXPECT_EQ(board.processes(kNow)[0].clock_offset_s, 0.0);
  EXPECT_FALSE(needs_attention(board.processes(kNow)[0]));
}

TEST(StatusText, NothingFromOutsideReachesTheTerminalAsACode) {
  StatusBoard board;
  bus::Status status = status_of("orchard-\033[31mx", "h\nost", 0, kNow);
  status.text = "a\033]0;title\007b";
  board.note(status, kNow);
  const std::string table = status_table(board.processes(kNow), 0, false);
  EXPECT_EQ(table.find('\033'), std::string::npos);
  EXPECT_EQ(table.find('\007'), std::string::npos);
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 3);
}

TEST(StatusText, JsonHoldsWhatTheTableShows) {
  StatusBoard board;
  bus::Status status = status_of("orchard-mapper", "a", 0, kNow);
  status.level = bus::Level::kError;
  status.num_lost = 3;
  status.text = "not saved";
  board.note(status, kNow);
  const auto json = nlohmann::json::parse(status_json(board.processes(kNow)));
  EXPECT_EQ(json["processes"][0]["name"], "orchard-mapper");
  EXPECT_EQ(json["processes"][0]["state"], "error");
  EXPECT_EQ(json["processes"][0]["num_lost"], 3);
  EXPECT_EQ(json["processes"][0]["text"], "not saved");
}

TEST(StatusText, LinesAreCutAtTheTerminalsWidth) {
  StatusBoard board;
  bus::Status status = status_of("orchard-mapper", "a-host-with-a-long-name", 0, kNow);
  status.text = std::string(300, 'x');
  board.note(status, kNow);
  std::istringstream table(status_table(board.processes(kNow), 60, false));
  for (std::string line; std::getline(table, line);) EXPECT_LE(line.size(), 60u) << line;
}

}  // namespace
}  // namespace orchard::cli
