// SPDX-License-Identifier: BSD-3-Clause

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "bus/node/live_inputs.hpp"
#include "bus/node/peer_processes.hpp"
#include "bus/replay/lockstep_protocol.hpp"

namespace orchard::bus {
namespace {

using std::chrono::milliseconds;
using Time = Inbox::Clock::time_point;

Inbox::Arrival scan(std::int32_t seq, Time time, std::size_t num_bytes = 100) {
  laser::Scan message;
  message.seq = seq;
  return {time, message, num_bytes};
}

std::vector<std::int32_t> take_all(Inbox& inbox, Time now) {
  std::vector<std::int32_t> seqs;
  while (const auto arrival = inbox.take(now)) seqs.push_back(seq_of(arrival->message));
  return seqs;
}

TEST(Inbox, PutsWhatANetworkHasSwappedInOrder) {
  std::vector<std::int32_t> expected(1000);
  std::iota(expected.begin(), expected.end(), 0);
  std::mt19937 random(4);
  for (int round = 0; round < 20; ++round) {
    // 40 messages a second, each up to 50 ms late
    std::vector<std::pair<double, std::int32_t>> order_ms;
    std::uniform_real_distribution<double> late_ms(0.0, 50.0);
    for (const std::int32_t seq : expected) {
      order_ms.emplace_back(25.0 * seq + (seq == 0 ? 0.0 : late_ms(random)), seq);
    }
    std::sort(order_ms.begin(), order_ms.end());
    Inbox inbox;
    std::vector<std::int32_t> taken;
    for (const auto& [ms, seq] : order_ms) {
      const Time now = Time() + milliseconds(static_cast<std::int64_t>(ms));
      inbox.add(scan(seq, now));
      for (const std::int32_t next : take_all(inbox, now)) taken.push_back(next);
    }
    inbox.release_all();
    for (const std::int32_t next : take_all(inbox, Time())) taken.push_back(next);
    EXPECT_EQ(taken, expected);
  }
}

TEST(Inbox, WaitsForAMissingMessageNoLongerThanNetworksSwap) {
  Inbox inbox;
  inbox.add(scan(0, Time()));
  inbox.add(scan(2, Time()));
  inbox.add(scan(3, Time()));
  EXPECT_EQ(take_all(inbox, Time()), (std::vector<std::int32_t>{0}));
  EXPECT_EQ(inbox.ms_until_next(Time()), 60);
  EXPECT_TRUE(take_all(inbox, Time() + milliseconds(59)).empty());
  EXPECT_EQ(take_all(inbox, Time() + milliseconds(60)), (std::vector<std::int32_t>{2, 3}));
  EXPECT_FALSE(inbox.ms_until_next(Time()));
}

TEST(Inbox, NoChannelOvertakesAnotherThatHasLostAMessage) {
  const auto odometry = [](int ms) {
    return Inbox::Arrival{Time() + milliseconds(ms), pose::Odometry{}, 100};
  };
  const auto taken = [](Inbox& inbox, int ms) {
    std::string order;
    while (const auto next = inbox.take(Time() + milliseconds(ms))) {
      order += channel_of(next->message) == Channel::kScan ? 's' : 'o';
    }
    return order;
  };
  Inbox lost;
  lost.add(scan(0, Time()));
  lost.add(scan(2, Time() + milliseconds(10)));
  lost.add(odometry(20));
  EXPECT_EQ(taken(lost, 20), "s");
  EXPECT_EQ(lost.ms_until_next(Time() + milliseconds(20)), 50);
  EXPECT_EQ(taken(lost, 70), "so");
  Inbox late;
  late.add(scan(0, Time()));
  late.add(scan(2, Time() + milliseconds(10)));
  late.add(odometry(20));
  late.add(scan(1, Time() + milliseconds(30)));
  EXPECT_EQ(taken(late, 30), "soss");
}

TEST(Inbox, ASourceThatBeginsAgainOrLeapsIsNotHeldUp) {
  Inbox inbox;
  for (const std::int32_t seq : {500, 501, 0, 1, 2, INT32_MAX, 3, 4}) {
    inbox.add(scan(seq, Time()));
  }
  EXPECT_EQ(take_all(inbox, Time()),
            (std::vector<std::int32_t>{500, 501, 0, 1, 2, INT32_MAX, 3, 4}));
}

TEST(Inbox, IsBoundedInMessagesAndBytes) {
  Inbox many;
  for (int i = 0; i < 100'000; ++i) many.add(scan(i, Time()));
  EXPECT_EQ(many.size(), Inbox::kMessagesMax);
  EXPECT_EQ(many.num_dropped(), 100'000 - static_cast<std::int64_t>(Inbox::kMessagesMax));
  pose::Odometry other;
  many.add({Time(), other, 100});
  EXPECT_EQ(many.size(), Inbox::kMessagesMax + 1) << "a flood on one channel leaves the others";

  Inbox large;
  for (int i = 0; i < 1000; ++i) large.add(scan(i, Time(), 1 << 20));
  EXPECT_EQ(large.size(), 64u);
  take_all(large, Time());
  large.add(scan(2000, Time(), 1 << 20));
  EXPECT_EQ(large.size(), 1u) << "what was taken makes room";

  Inbox gaps;
  for (int i = 0; i < 100'000; ++i) gaps.add(scan(2 * i, Time()));
  EXPECT_LE(gaps.size(), Inbox::kMessagesMax);
}

TEST(Inbox, ANodeThatStoppedForLessThanASecondLosesNoImageAndASlowOneTheOldest) {
  const auto left_of = [](int num, bool needs_images) {
    Inbox inbox(needs_images);
    for (int i = 0; i < num; ++i) {  // 50 images a second
      const Time time = Time() + milliseconds(20 * i);
      vision::Image image;
      image.seq = i;
      inbox.add({time, image, 100});
      inbox.add(scan(i, time));
    }
    std::int64_t num_images = 0;
    while (const auto arrival = inbox.take(Time() + milliseconds(20 * num))) {
      num_images += channel_of(arrival->message) == Channel::kImage ? 1 : 0;
    }
    return num_images;
  };
  EXPECT_EQ(left_of(50, true), 50);
  EXPECT_EQ(left_of(150, true), 51) << "the newest second's";
  EXPECT_EQ(left_of(150, false), 150) << "of a node that may use each of them late";
}

using std::chrono::milliseconds;
using Time = InputWatch::Clock::time_point;

Time at_ms(int ms) { return Time() + milliseconds(ms); }

TEST(InputWatch, AChannelThatFallsSilentIsStaleWithinASecond) {
  InputWatch watch;
  EXPECT_FALSE(watch.update(at_ms(0)));
  for (int i = 0; i < 20; ++i) watch.note(Channel::kScan, at_ms(100 * i));
  EXPECT_FALSE(watch.update(at_ms(1900)));
  EXPECT_EQ(watch.ms_until_change(at_ms(1900)), 500);
  EXPECT_FALSE(watch.update(at_ms(2399)));
  EXPECT_TRUE(watch.text(Channel::kScan, at_ms(2399)).empty());
  EXPECT_TRUE(watch.update(at_ms(2400)));
  EXPECT_TRUE(watch.is_stale(Channel::kScan));
  EXPECT_TRUE(watch.is_serious(Channel::kScan));
  EXPECT_EQ(watch.text(Channel::kScan, at_ms(4200)),
            "SCAN is STALE: silent for 2.3 s (usual period 0.10 s)");
  EXPECT_FALSE(watch.update(at_ms(3000))) << "it is known already";
  watch.note(Channel::kScan, at_ms(5000));
  EXPECT_TRUE(watch.update(at_ms(5000))) << "it is back";
  EXPECT_FALSE(watch.is_stale(Channel::kScan));
}

TEST(InputWatch, ASlowChannelMayBeSilentForThreeOfItsPeriods) {
  InputWatch watch;
  for (int i = 0; i < 10; ++i) watch.note(Channel::kGnss, at_ms(1000 * i));
  EXPECT_FALSE(watch.update(at_ms(11'900)));
  EXPECT_TRUE(watch.update(at_ms(12'000)));
}

TEST(InputWatch, OneLongSilenceDoesNotMakeTheNextOneUsual) {
  InputWatch watch;
  for (int i = 0; i < 10; ++i) watch.note(Channel::kScan, at_ms(100 * i));
  for (int i = 0; i < 10; ++i) watch.note(Channel::kScan, at_ms(60'000 + 100 * i));
  EXPECT_FALSE(watch.update(at_ms(61'300)));
  EXPECT_TRUE(watch.update(at_ms(61'400)));
}

TEST(InputWatch, WhatNeverCameOrCameOnceIsNotStale) {
  InputWatch watch;
  watch.note(Channel::kPoseFix, at_ms(0));
  EXPECT_FALSE(watch.update(at_ms(1'000'000)));
}

TEST(InputWatch, SaysTheSharesOfTheLastTenSeconds) {
  InputWatch watch;
  SequenceCounts counts;
  watch.count(Channel::kScan, counts, 1000);
  EXPECT_TRUE(watch.text(Channel::kScan, Time()).empty());
  counts.num_lost = 5;
  counts.num_duplicate = 10;
  counts.num_jumps = 1;
  watch.count(Channel::kScan, counts, 1095);
  EXPECT_EQ(
      watch.text(Channel::kScan, Time()),
      "SCAN in the last 10 s: 5.0 % lost, 10.0 % duplicate, 1 refused for a jump in time or seq");
  EXPECT_TRUE(watch.is_serious(Channel::kScan));
  for (int i = 0; i < 11; ++i) watch.count(Channel::kScan, counts, 1095 + 100 * i);
  EXPECT_TRUE(watch.text(Channel::kScan, Time()).empty()) << "that was ten seconds ago";
  EXPECT_FALSE(watch.is_serious(Channel::kScan));
}

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
    mine.note(status_of("orchard-detector", "robot:5", 3, kWall - 150'000 - delay_us), kWall,
              Time());
  }
  const std::string text = mine.text(Time());
  EXPECT_NE(text.find("the clock of laptop"), std::string::npos) << text;
  EXPECT_EQ(text.find("the clock of robot"), std::string::npos) << "it is this machine";
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

TEST(LockstepSteps, AreSplitAtTheMessagesOfThePlayer) {
  const std::vector<OutputId> round = {{Channel::kScan, 4}, {Channel::kOdometry, 9}};
  const OutputId pose{Channel::kPose, 7}, detections{Channel::kDetections, 4};
  Ack ack;
  EXPECT_EQ(steps_of(ack, round), LockstepSteps());
  ack.outputs = {round[0], detections, pose, round[1]};
  EXPECT_EQ(steps_of(ack, round), (LockstepSteps{{detections, pose}, {}}));
  ack.outputs = {round[0], detections};  // not all of the round yet
  EXPECT_EQ(steps_of(ack, round), (LockstepSteps{{detections}}));
  ack.outputs = {detections};  // of another round
  EXPECT_EQ(steps_of(ack, round), std::nullopt);
}

TEST(LockstepUrl, IsTheSameNetworkOnAPortOfItsOwn) {
  EXPECT_EQ(lockstep_url("udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304"),
            "udpm://239.255.76.67:17667?ttl=0&recv_buf_size=4194304");
  EXPECT_EQ(lockstep_url("udpm://239.255.76.67:60000"), "udpm://239.255.76.67:50000");
  EXPECT_EQ(lockstep_url("udpm://"), "udpm://239.255.76.67:17667");
  EXPECT_EQ(lockstep_url("udpm://:7700?ttl=1"), "udpm://239.255.76.67:17700?ttl=1");
  EXPECT_EQ(lockstep_url("udpm://239.1.2.3"), "udpm://239.1.2.3:17667");
  EXPECT_EQ(lockstep_url("memq://"), "memq://");
}

}  // namespace

}  // namespace orchard::bus
