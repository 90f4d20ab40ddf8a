// SPDX-License-Identifier: BSD-3-Clause
#include "bus/node/peer_processes.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace orchard::bus {
namespace {

using std::chrono::seconds;
using Time = PeerProcesses::Clock::time_point;

constexpr std::int64_t kWall = 1'700'000'000'000'000;

Status status_of(const std::string& name, const std::string& host, std::int32_t seq,
                 std::int64_t utime = kWall) {
  Status status;
  status.name = name;
  status.host = host;
  status.seq = seq;
  status.utime = utime;
  return status;
}

TEST(PeerProcesses, NamesASecondOfItsNameAndForgetsIt) {
  PeerProcesses mine("orchard-mapper", "robot:1", 7);
  EXPECT_FALSE(mine.note(status_of("orchard-mapper", "robot:1", 3), kWall, Time())) << "itself";
  EXPECT_TRUE(mine.note(status_of("orchard-pose", "robot:2", 3), kWall, Time()));
  EXPECT_TRUE(mine.duplicate(Time()).empty());
  EXPECT_TRUE(mine.note(status_of("orchard-mapper", "laptop:1", 3), kWall, Time()));
  EXPECT_FALSE(mine.note(status_of("orchard-mapper", "laptop:1", 4), kWall, Time())) << "known";
  EXPECT_EQ(mine.duplicate(Time()), "orchard-mapper on laptop:1");
  EXPECT_TRUE(mine.duplicate_is_older(3, Time()));
  EXPECT_FALSE(mine.duplicate_is_older(5, Time()));
  EXPECT_TRUE(mine.duplicate(Time() + seconds(4)).empty());
}

TEST(PeerProcesses, OfTwoThatBeginTogetherExactlyOneIsOlder) {
  PeerProcesses a("orchard-mapper", "robot:1", 7);
  PeerProcesses b("orchard-mapper", "robot:2", 7);
  a.note(status_of("orchard-mapper", "robot:2", 1), kWall, Time());
  b.note(status_of("orchard-mapper", "robot:1", 1), kWall, Time());
  EXPECT_NE(a.duplicate_is_older(1, Time()), b.duplicate_is_older(1, Time()));
}

TEST(PeerProcesses, SaysWhoHasAnotherConfiguration) {
  PeerProcesses mine("orchard-mapper", "robot:1", 7);
  mine.note(status_of("orchard-pose", "laptop:5", 3), kWall, Time());
  ConfigNotice notice;
  notice.name = "orchard-pose";
  notice.hash = 7;
  mine.note(notice, Time());
  EXPECT_TRUE(mine.text(Time()).empty());
  notice.hash = 8;
  mine.note(notice, Time());
  EXPECT_EQ(mine.text(Time()), "another configuration is used by orchard-pose on laptop:5");
}

TEST(PeerProcesses, SaysWhoseClockIsAnother) {
  PeerProcesses mine("orchard-mapper", "robot:1", 7);
  // 0.2 s ahead, and on its way for up to 0.15 s
  for (const std::int64_t delay_us : {150'000, 2'000, 90'000, 140'000}) {
    mine.note(status_of("orchard-pose", "laptop:5", 3, kWall + 200'000 - delay_us), kWall, Time());
    mine.note(status_of("orchard-detector", "robot:5", 3, kWall - delay_us), kWall, Time());
  }
  const std::string text = mine.text(Time());
  EXPECT_NE(text.find("the clock of laptop"), std::string::npos) << text;
  EXPECT_EQ(text.find("the clock of robot"), std::string::npos) << "a delay is no other clock";
}

TEST(PeerProcesses, NoticesThatTheClockWasSet) {
  for (const double hour_s : {3600.0, -3600.0}) {
    PeerProcesses mine("orchard-mapper", "robot:1", 7);
    const auto step_us = static_cast<std::int64_t>(1e6 * hour_s);
    EXPECT_EQ(mine.check_clock(kWall, Time() + seconds(1)), 0.0);
    EXPECT_EQ(mine.check_clock(kWall + 1'000'000, Time() + seconds(2)), 0.0);
    EXPECT_DOUBLE_EQ(mine.check_clock(kWall + 2'000'000 + step_us, Time() + seconds(3)), hour_s);
    EXPECT_NE(mine.text(Time() + seconds(4)).find("of this machine was changed"),
              std::string::npos);
    EXPECT_EQ(mine.check_clock(kWall + 3'000'000 + step_us, Time() + seconds(4)), 0.0);
    EXPECT_TRUE(mine.text(Time() + seconds(70)).empty());
  }
}

TEST(PeerProcesses, NamesFromOutsideDoNotFillTheMemory) {
  PeerProcesses mine("orchard-mapper", "robot:1", 7);
  for (int i = 0; i < 10'000; ++i) {
    mine.note(status_of("orchard-driver" + std::to_string(i), "x:1", 1), kWall, Time());
  }
  const std::string named = mine.named("orchard-driver", Time());
  EXPECT_LE(std::count(named.begin(), named.end(), ','), 63);
}

}  // namespace
}  // namespace orchard::bus
