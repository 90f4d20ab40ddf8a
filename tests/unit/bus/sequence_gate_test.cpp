// SPDX-License-Identifier: BSD-3-Clause
#include "bus/node/sequence_gate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace orchard::bus {
namespace {

constexpr std::int64_t kSecond = 1'000'000;
constexpr std::int64_t kHour = 3600 * kSecond;
constexpr std::int64_t kStart = 1'700'000'000 * kSecond;
constexpr int kMany = SequenceGate::kNumToConfirm;

/// Ten messages per second from `seq` on; how many were taken at once.
int drive(SequenceGate& gate, Channel channel, std::int32_t seq, std::int64_t utime, int num) {
  int num_new = 0;
  for (int i = 0; i < num; ++i) {
    num_new +=
        gate.accept(channel, seq + i, utime + i * kSecond / 10) == GateDecision::kNew ? 1 : 0;
  }
  return num_new;
}

TEST(SequenceGate, CountsWhatIsMissing) {
  SequenceGate gate;
  EXPECT_EQ(gate.accept(Channel::kScan, 10, 100),
            GateDecision::kNew);  // a late joiner has lost nothing
  EXPECT_EQ(gate.accept(Channel::kScan, 11, 200), GateDecision::kNew);
  EXPECT_EQ(gate.accept(Channel::kScan, 15, 300), GateDecision::kNew);
  EXPECT_EQ(gate.counts().num_lost, 3);
}

TEST(SequenceGate, RefusesTheSameAgain) {
  SequenceGate gate;
  EXPECT_EQ(drive(gate, Channel::kScan, 0, kStart, 100), 100);
  EXPECT_EQ(gate.accept(Channel::kScan, 99, kStart + 99 * kSecond / 10), GateDecision::kDuplicate);
  EXPECT_EQ(gate.accept(Channel::kScan, 3, kStart + 3 * kSecond / 10), GateDecision::kDuplicate);
  EXPECT_EQ(drive(gate, Channel::kScan, 50, kStart + 5 * kSecond, 50), 0) << "half of it again";
  EXPECT_EQ(gate.counts().num_duplicate, 52);
  EXPECT_EQ(gate.counts().num_lost, 0);
  EXPECT_EQ(gate.accept(Channel::kImage, 9, kStart),
            GateDecision::kNew);  // each channel on its own
}

TEST(SequenceGate, CountsAReorderedMessageOnce) {
  SequenceGate gate;
  drive(gate, Channel::kScan, 0, kStart, 10);
  EXPECT_EQ(gate.accept(Channel::kScan, 12, kStart + 12 * kSecond / 10), GateDecision::kNew);
  EXPECT_EQ(gate.counts().num_lost, 2);
  EXPECT_EQ(gate.accept(Channel::kScan, 11, kStart + 11 * kSecond / 10), GateDecision::kReordered);
  EXPECT_EQ(gate.accept(Channel::kScan, 10, kStart + 10 * kSecond / 10), GateDecision::kReordered);
  EXPECT_EQ(gate.accept(Channel::kScan, 10, kStart + 10 * kSecond / 10), GateDecision::kDuplicate);
  EXPECT_EQ(gate.counts().num_lost, 0);
  EXPECT_EQ(gate.counts().num_reordered, 2);
  EXPECT_EQ(gate.counts().num_duplicate, 1);
}

TEST(SequenceGate, ABurstThatWasHeldUpFillsItsGap) {
  SequenceGate gate;
  drive(gate, Channel::kScan, 0, kStart, 10);
  drive(gate, Channel::kScan, 30, kStart + 3 * kSecond, 10);
  EXPECT_EQ(gate.counts().num_lost, 20);
  for (int i = 10; i < 30; ++i) {
    EXPECT_EQ(gate.accept(Channel::kScan, i, kStart + i * kSecond / 10), GateDecision::kReordered);
  }
  EXPECT_EQ(gate.counts().num_lost, 0);
  EXPECT_EQ(gate.counts().num_restarts, 0);
}

// Five messages two hours ahead are held until they agree; each of them came, and comes again.
TEST(SequenceGate, AHeldMessageThatComesAgainIsADuplicate) {
  SequenceGate gate;
  drive(gate, Channel::kScan, 0, kStart, 10);
  drive(gate, Channel::kScan, 10, kStart + 2 * kHour, 10);
  EXPECT_EQ(gate.counts().num_lost, 0);
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(gate.accept(Channel::kScan, 10 + i, kStart + 2 * kHour + i * kSecond / 10),
              GateDecision::kDuplicate)
        << i;
  }
  EXPECT_EQ(gate.counts().num_lost, 0);
}

// A second source begins and the first goes on: what was sent before it was first heard is not
// lost.
TEST(SequenceGate, BesideASecondSourceNothingMoreWasLost) {
  SequenceGate gate;
  gate.accept(Channel::kScan, 5000, kStart);
  gate.accept(Channel::kScan, 0, kStart + kSecond / 20);
  gate.accept(Channel::kScan, 5001, kStart + kSecond / 10);
  gate.accept(Channel::kScan, 4999, kStart - kSecond / 10);
  EXPECT_EQ(gate.counts().num_lost, 0);
}

// Whatever is swapped, repeated, lost and restarted: a count is not negative.
TEST(SequenceGate, NeverCountsLessThanNothing) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    SequenceGate gate;
    std::mt19937 random(seed);
    std::int32_t seq = 0;
    std::int64_t utime = kStart;
    std::vector<std::pair<std::int32_t, std::int64_t>> sent;
    for (int i = 0; i < 300; ++i) {
      if (random() % 50 == 0) seq = static_cast<std::int32_t>(random() % 3000);
      if (random() % 60 == 0) utime += (random() % 2 == 0 ? 1 : -1) * 2 * kHour;
      sent.emplace_back(seq++, utime += kSecond / 10);
      const std::size_t back = random() % std::min<std::size_t>(sent.size(), 20);
      const auto [some_seq, some_utime] = sent[sent.size() - 1 - (random() % 3 == 0 ? back : 0)];
      if (random() % 10 != 0) gate.accept(Channel::kScan, some_seq, some_utime);
      ASSERT_GE(gate.counts().num_lost, 0) << "seed " << seed << ", message " << i;
    }
  }
}

TEST(SequenceGate, AcceptsARestartedSourceAtOnce) {
  SequenceGate gate;
  EXPECT_EQ(gate.accept(Channel::kScan, 500, 100), GateDecision::kNew);
  EXPECT_EQ(gate.accept(Channel::kScan, 0, 5000), GateDecision::kNew);
  EXPECT_EQ(gate.accept(Channel::kScan, 1, 5100), GateDecision::kNew);
  EXPECT_EQ(gate.counts().num_restarts, 1);
  EXPECT_EQ(gate.counts().num_lost, 0);
}

TEST(SequenceGate, SeveralMessagesMayHaveOneTime) {
  SequenceGate gate;
  EXPECT_EQ(gate.accept(Channel::kPose, 0, 100), GateDecision::kNew);
  EXPECT_EQ(gate.accept(Channel::kPose, 1, 100), GateDecision::kNew);
}

TEST(SequenceGate, OneLeapOfTimeOrNumberIsNotBelieved) {
  const std::int64_t far = 7'258'118'400 * kSecond - 1;
  const std::pair<std::int32_t, std::int64_t> leaps[] = {
      {INT32_MAX, far}, {100, far}, {100, kStart + 24 * kHour}, {INT32_MAX, kStart + 10 * kSecond},
      {INT32_MAX, 0},   {0, 0}};
  for (const auto& [seq, utime] : leaps) {
    SequenceGate gate;
    drive(gate, Channel::kScan, 0, kStart, 100);
    EXPECT_EQ(gate.accept(Channel::kScan, seq, utime), GateDecision::kHeld) << seq << " " << utime;
    EXPECT_EQ(drive(gate, Channel::kScan, 100, kStart + 10 * kSecond, 100), 100);
    EXPECT_EQ(gate.counts().num_jumps, 1) << seq << " " << utime;
    EXPECT_EQ(gate.counts().num_lost, 0);
    EXPECT_EQ(gate.counts().num_restarts, 0);
  }
}

TEST(SequenceGate, ALeapIsBelievedWhenSeveralAgreeInEitherDirection) {
  for (const std::int64_t leap : {-kHour, kHour}) {
    SequenceGate gate;
    drive(gate, Channel::kScan, 0, kStart, 100);
    for (int i = 0; i < kMany - 1; ++i) {
      EXPECT_EQ(gate.accept(Channel::kScan, i, kStart + leap + i), GateDecision::kHeld);
      EXPECT_EQ(gate.num_held(Channel::kScan), i + 1);
    }
    EXPECT_EQ(gate.accept(Channel::kScan, kMany, kStart + leap + kMany), GateDecision::kConfirmed);
    EXPECT_EQ(drive(gate, Channel::kScan, kMany + 1, kStart + leap + kMany + 1, 50), 50);
    EXPECT_EQ(gate.counts().num_restarts, 1);
    EXPECT_EQ(gate.counts().num_jumps, 0) << "those that were held are used";
    EXPECT_NEAR(gate.counts(Channel::kScan).clock_change_s, 1e-6 * static_cast<double>(leap), 11.0);
  }
}

TEST(SequenceGate, AChannelThatLeapsAloneIsRefusedWhileTheOthersStay) {
  for (const std::int64_t leap : {-24 * kHour, -5 * kSecond, 24 * kHour}) {
    SequenceGate gate;
    int seq = 0;
    for (; seq < 500; ++seq) {
      const std::int64_t utime = kStart + seq * kSecond / 10;
      EXPECT_EQ(gate.accept(Channel::kGnss, seq, utime), GateDecision::kNew);
      const bool leaps = seq >= 100 && seq < 400;
      const GateDecision decision = gate.accept(Channel::kScan, seq, utime + (leaps ? leap : 0));
      // A fall of five seconds is over when its clock comes to the time again that it was set at.
      const bool is_held = leaps && (leap != -5 * kSecond || seq < 149);
      EXPECT_EQ(decision, is_held ? GateDecision::kHeld : GateDecision::kNew) << seq;
    }
    EXPECT_EQ(gate.counts().num_restarts, 0);
    EXPECT_LE(gate.num_held(Channel::kScan), SequenceGate::kNumAlone);
  }
}

TEST(SequenceGate, AChannelThatLeapsWhenTheOthersHaveGoneIsBelieved) {
  SequenceGate gate;
  drive(gate, Channel::kScan, 0, kStart, 100);
  drive(gate, Channel::kGnss, 0, kStart, 100);
  int num = 0;
  while (gate.accept(Channel::kScan, 100 + num, kStart - kHour + num * kSecond / 10) !=
         GateDecision::kConfirmed) {
    ASSERT_LT(++num, 2 * SequenceGate::kNumAlone);
  }
  EXPECT_EQ(num, SequenceGate::kNumAlone - 1);
}

TEST(SequenceGate, TwoChannelsThatLeapTogetherConfirmEachOther) {
  SequenceGate gate;
  for (const Channel channel : {Channel::kScan, Channel::kGnss, Channel::kImu}) {
    for (int i = 0; i < 10; ++i) {
      const std::int64_t utime = kStart + i * kSecond / 10;
      ASSERT_EQ(gate.accept(channel, i, utime), GateDecision::kNew);
      ASSERT_EQ(gate.drive_time(channel, utime), utime);
    }
  }
  EXPECT_EQ(gate.accept(Channel::kGnss, 10, kStart - kHour), GateDecision::kHeld);
  for (int i = 0; i < kMany - 1; ++i) {
    EXPECT_EQ(gate.accept(Channel::kScan, 10 + i, kStart - kHour + i), GateDecision::kHeld);
    EXPECT_FALSE(gate.confirm_held(Channel::kGnss));
  }
  EXPECT_EQ(gate.accept(Channel::kScan, 14, kStart - kHour + 4), GateDecision::kConfirmed);
  EXPECT_EQ(gate.drive_time(Channel::kScan, kStart - kHour), timing::kEpoch_us + kStart - kHour);
  EXPECT_TRUE(gate.confirm_held(Channel::kGnss)) << "it need not wait for its next message";
  EXPECT_EQ(gate.num_held(Channel::kGnss), 0);
  EXPECT_EQ(gate.accept(Channel::kImu, 10, kStart - kHour), GateDecision::kNew);
}

TEST(SequenceGate, ADuplicateAmongThoseThatAgreeDoesNotPutThemOff) {
  SequenceGate gate;
  drive(gate, Channel::kScan, 0, kStart, 100);
  GateDecision decision = GateDecision::kHeld;
  for (int i = 0; i < kMany; ++i) {
    decision = gate.accept(Channel::kScan, i, kStart - kHour + i);
    if (i < kMany - 1) {
      EXPECT_EQ(gate.accept(Channel::kScan, i, kStart - kHour + i), GateDecision::kDuplicate);
    }
  }
  EXPECT_EQ(decision, GateDecision::kConfirmed);
}

TEST(SequenceGate, ARobotThatPausesLosesNothing) {
  SequenceGate gate;
  const std::int64_t arrival = 5 * kHour;  // by another clock than the source's
  EXPECT_EQ(gate.accept(Channel::kScan, 0, kStart, arrival), GateDecision::kNew);
  EXPECT_EQ(gate.accept(Channel::kGnss, 0, kStart, arrival), GateDecision::kNew);
  const std::int64_t pause = 25 * 60 * kSecond;
  EXPECT_EQ(gate.accept(Channel::kScan, 1, kStart + pause, arrival + pause + kSecond),
            GateDecision::kNew);
  EXPECT_EQ(gate.accept(Channel::kGnss, 1, kStart + pause, arrival + pause), GateDecision::kNew);
  // As much time by the source alone is a leap, and so is a day.
  EXPECT_EQ(gate.accept(Channel::kImage, 0, kStart + pause, arrival + pause), GateDecision::kNew);
  EXPECT_EQ(gate.accept(Channel::kScan, 2, kStart + 2 * pause, arrival + pause + kSecond),
            GateDecision::kHeld);
  EXPECT_EQ(gate.accept(Channel::kGnss, 2, kStart + 24 * kHour, arrival + 24 * kHour),
            GateDecision::kHeld);
  EXPECT_EQ(gate.counts().num_lost, 0);
  EXPECT_EQ(gate.counts().num_restarts, 0);
  EXPECT_EQ(gate.counts().clock_change_s, 0.0);
}

TEST(SequenceGate, ASourceWhoseTimeRunsThreeTimesAsFastLosesNothing) {
  for (const std::int64_t period_us : {kSecond / 50, kSecond / 10, kSecond}) {
    SequenceGate gate;
    for (int k = 0; k < 200; ++k) {
      EXPECT_EQ(gate.accept(Channel::kScan, k, kStart + k * period_us, k * period_us / 3),
                GateDecision::kNew)
          << k << " of a period of " << period_us << " us";
    }
  }
}

TEST(SequenceGate, WhatWasKeptAsideIsUsedWhenAnotherChannelComesToItsTime) {
  SequenceGate gate;
  drive(gate, Channel::kScan, 0, kStart, 10);
  drive(gate, Channel::kGnss, 0, kStart, 10);
  for (int i = 0; i < kMany - 1; ++i) {
    EXPECT_EQ(gate.accept(Channel::kScan, 10 + i, kStart + kHour + i * kSecond),
              GateDecision::kHeld);
    EXPECT_EQ(gate.accept(Channel::kGnss, 10 + i, kStart + kHour + i * kSecond),
              GateDecision::kHeld);
  }
  const int last = 10 + kMany - 1;
  const std::int64_t now = kStart + kHour + kMany * kSecond;
  EXPECT_EQ(gate.accept(Channel::kScan, last, now), GateDecision::kConfirmed);
  EXPECT_EQ(gate.accept(Channel::kGnss, last, now), GateDecision::kConfirmed);
  EXPECT_EQ(gate.counts().num_jumps, 0);
  EXPECT_EQ(gate.counts().num_lost, 0);
}

TEST(SequenceGate, OneMessageOfHalfAMinuteAheadShutsNobodyOut) {
  SequenceGate gate;
  const auto accept = [&gate](std::int32_t seq, std::int64_t utime, std::int64_t arrival) {
    return gate.accept(Channel::kScan, seq, kStart + utime, 7 * kHour + arrival);
  };
  EXPECT_EQ(accept(0, 0, 0), GateDecision::kNew);
  EXPECT_EQ(accept(1, kSecond / 10, kSecond / 10), GateDecision::kNew);
  EXPECT_EQ(accept(2, 30 * kSecond, kSecond / 5), GateDecision::kHeld);
  for (int i = 2; i < 20; ++i) {
    EXPECT_EQ(accept(i, i * kSecond / 10, i * kSecond / 10), GateDecision::kNew) << i;
  }
  EXPECT_EQ(gate.counts().num_jumps, 1);
  EXPECT_EQ(gate.counts().num_lost, 0);
}

TEST(SequenceGate, ALinkThatSkipsSomeSecondsAndCatchesUpLosesOnlyThose) {
  SequenceGate gate;
  int num_used = 0;
  const auto accept = [&](std::int32_t seq, std::int64_t arrival) {
    const GateDecision decision =
        gate.accept(Channel::kScan, seq, kStart + seq * kSecond / 10, arrival);
    if (decision == GateDecision::kNew) num_used += 1;
    if (decision == GateDecision::kConfirmed) num_used += kMany;
  };
  for (int i = 0; i < 100; ++i) accept(i, i * kSecond / 10);
  // Held up for ten seconds; of what waited the middle is lost, the rest comes at once.
  for (int i = 100; i < 120; ++i) accept(i, 20 * kSecond);
  for (int i = 170; i < 200; ++i) accept(i, 20 * kSecond);
  for (int i = 200; i < 300; ++i) accept(i, i * kSecond / 10);
  EXPECT_EQ(num_used, 250);
  EXPECT_EQ(gate.counts().num_lost, 50);
  EXPECT_EQ(gate.counts().num_restarts, 0);
  EXPECT_EQ(gate.counts().num_jumps, 0);
}

TEST(SequenceGate, ManyForgedOnesHoldUpNoSourceForLong) {
  // Real messages of which some bytes of time and number were changed, one for each real one: what
  // stands near enough to be believed must not bring the next one nearer.
  for (const std::int64_t period : {kSecond / 50, kSecond / 10, kSecond}) {
    std::mt19937 random(7);
    const auto below = [&](unsigned most) { return random() % most; };
    SequenceGate gate;
    std::int64_t longest = 0, last_used = kStart;
    int num_used = 0, num_held = 0;
    constexpr int kNum = 20000;
    for (int i = 0; i < kNum; ++i) {
      const std::int64_t utime = kStart + i * period;
      const std::int64_t arrival = i * period + below(20'000);
      const GateDecision decision = gate.accept(Channel::kScan, i, utime, arrival);
      num_held = decision == GateDecision::kHeld ? num_held + 1 : num_held;
      if (decision == GateDecision::kNew || decision == GateDecision::kConfirmed) {
        num_used += decision == GateDecision::kConfirmed ? 1 + num_held : 1;
        num_held = 0;
        longest = std::max(longest, utime - last_used);
        last_used = utime;
      }
      std::uint64_t forged_utime = static_cast<std::uint64_t>(utime);
      std::uint32_t forged_seq = static_cast<std::uint32_t>(i);
      for (unsigned k = 1 + below(4); k > 0; --k) {
        const unsigned byte = below(12);
        if (byte < 8) {
          forged_utime = (forged_utime & ~(0xffull << (8 * byte))) | (below(256) + 0ull)
                                                                         << (8 * byte);
        } else {
          forged_seq = (forged_seq & ~(0xffu << (8 * byte - 64))) | below(256) << (8 * byte - 64);
        }
      }
      if (forged_seq > 0x7fffffff || forged_utime > 0x7fffffffffffffff) continue;
      gate.accept(Channel::kScan, static_cast<std::int32_t>(forged_seq),
                  static_cast<std::int64_t>(forged_utime), arrival + 1000);
    }
    EXPECT_GT(num_used, kNum * 97 / 100) << period;
    EXPECT_LE(longest, std::max<std::int64_t>(3 * kMany * period, kSecond)) << period;
  }
}

TEST(SequenceGate, OneThatComesEarlyIsUsedWithTheNext) {
  SequenceGate gate;
  int num_used = 0;
  for (int i = 0; i < 100; ++i) {
    // A link that holds all up by 0.3 s, but one; 50 messages a second.
    const std::int64_t arrival = i * kSecond / 50 + (i == 60 ? 0 : 3 * kSecond / 10);
    const GateDecision decision =
        gate.accept(Channel::kOdometry, i, kStart + i * kSecond / 50, arrival);
    if (decision == GateDecision::kNew) num_used += 1;
    if (decision == GateDecision::kConfirmed) num_used += 2;
  }
  EXPECT_EQ(num_used, 100);
  EXPECT_EQ(gate.counts().num_jumps, 0);
}

TEST(SequenceGate, OtherChannelsKnowWhatTimeItIs) {
  SequenceGate gate;
  drive(gate, Channel::kPoseFix, 0, kStart, 1);
  drive(gate, Channel::kOdometry, 0, kStart, 6000);
  EXPECT_EQ(gate.accept(Channel::kPoseFix, 1, kStart + 600 * kSecond), GateDecision::kNew)
      << "ten minutes after the last one, as the wheels say too";
}

TEST(SequenceGate, AFirstMessageOfTheFutureDoesNotShutTheOthersOut) {
  SequenceGate gate;
  EXPECT_EQ(gate.accept(Channel::kScan, 7, kStart + 24 * kHour), GateDecision::kNew);
  EXPECT_EQ(drive(gate, Channel::kOdometry, 0, kStart, 50), 50 - kMany);
  EXPECT_EQ(drive(gate, Channel::kScan, 8, kStart + 5 * kSecond, 50), 50)
      << "the wheels say what time it is";
}

TEST(SequenceGate, ASourceThatPlaysTheSameLaterIsNoticed) {
  SequenceGate gate;
  drive(gate, Channel::kScan, 0, kStart, 30);
  for (int i = 0; i < 30; ++i) {
    gate.accept(Channel::kScan, 30 + i, kStart + (30 + i) * kSecond / 10);
    gate.accept(Channel::kScan, 230 + i, kStart + (230 + i) * kSecond / 10);
  }
  EXPECT_GT(gate.counts().num_second_source_signs, 20);
}

TEST(SequenceGate, OfTwoSourcesTheFirstIsKept) {
  SequenceGate gate;
  drive(gate, Channel::kScan, 5000, kStart, 20);
  int num_second = 0;
  for (int i = 0; i < 100; ++i) {
    const std::int64_t utime = kStart + (20 + i) * kSecond / 10;
    EXPECT_EQ(gate.accept(Channel::kScan, 5020 + i, utime), GateDecision::kNew);
    num_second += gate.accept(Channel::kScan, i, utime + 30000) == GateDecision::kNew ? 1 : 0;
  }
  EXPECT_EQ(num_second, 1) << "it might have been the first one, started again";
  EXPECT_GT(gate.counts().num_second_source_signs, 50);
  EXPECT_EQ(gate.counts().num_lost, 0);
}

}  // namespace
}  // namespace orchard::bus
