// SPDX-License-Identifier: BSD-3-Clause
#include "bus/node/inbox.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

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

}  // namespace
}  // namespace orchard::bus
