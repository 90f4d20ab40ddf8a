// SPDX-License-Identifier: BSD-3-Clause
#include "timing/ordered_queue.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

namespace orchard::timing {
namespace {

/// Items are their own kind and time, to see them come out.
using Entry = std::pair<std::int64_t, std::size_t>;
using Queue = OrderedQueue<Entry, 3>;

void push(Queue& queue, std::size_t kind, std::int64_t utime) {
  queue.push(kind, utime, {utime, kind});
}

std::vector<Entry> drain(Queue& queue) {
  std::vector<Entry> out;
  while (const auto entry = queue.pop()) out.push_back(*entry);
  return out;
}

/// Kinds 0 and 1 are waited for, as long for each; kind 2 never.
Queue two_kinds(std::int64_t wait_us) { return Queue({{{wait_us}, {wait_us}, {}}}); }

TEST(OrderedQueue, HoldsAnItemUntilTheOtherKindReachesItsTime) {
  Queue queue = two_kinds(100);
  push(queue, 0, 1000);
  EXPECT_FALSE(queue.pop());
  EXPECT_EQ(queue.blocker(1000), 1u);
  push(queue, 1, 1000);
  EXPECT_EQ(drain(queue), (std::vector<Entry>{{1000, 0}, {1000, 1}}));
  EXPECT_FALSE(queue.next_kind());
}

TEST(OrderedQueue, TheWaitReleasesWhatASilentKindHoldsBack) {
  Queue queue = two_kinds(20);
  push(queue, 0, 0);
  push(queue, 0, 20);
  EXPECT_FALSE(queue.pop());
  push(queue, 0, 21);
  EXPECT_EQ(drain(queue), (std::vector<Entry>{{0, 0}}));
}

TEST(OrderedQueue, EachKindIsWaitedForAsLongAsItsOwnRule) {
  Queue queue({{{20}, {10}, {500}}});
  push(queue, 0, 0);
  push(queue, 0, 100);
  EXPECT_EQ(queue.blocker(0), 2u);
  push(queue, 0, 501);
  EXPECT_EQ(drain(queue), (std::vector<Entry>{{0, 0}}));
  push(queue, 2, 100);
  EXPECT_EQ(drain(queue), (std::vector<Entry>{{100, 0}, {100, 2}}));  // equal times: by kind
}

TEST(OrderedQueue, AKindThatTellsNoTimeReleasesNothingByItself) {
  Queue queue({{{20}, {20}, {std::nullopt, false}}});
  push(queue, 0, 0);
  queue.reach(2, 1000);
  EXPECT_FALSE(queue.pop());
  EXPECT_EQ(queue.message_time(), 0);
  queue.set_wait(1, std::nullopt);
  EXPECT_EQ(drain(queue), (std::vector<Entry>{{0, 0}}));
}

TEST(OrderedQueue, AnItemMayNeedAKindBeyondItsOwnTime) {
  Queue queue = two_kinds(100);
  push(queue, 0, 50);
  queue.reach(1, 60);
  EXPECT_FALSE(queue.blocker(50));
  EXPECT_EQ(queue.blocker(50, [](std::size_t kind) { return kind == 1 ? 61 : 50; }), 1u);
  queue.reach(1, 61);
  EXPECT_FALSE(queue.blocker(50, [](std::size_t kind) { return kind == 1 ? 61 : 50; }));
}

TEST(OrderedQueue, ItemsOfOneKindComeInOrderOfTimeWhateverTheyArriveIn) {
  Queue queue({{{}, {}, {}}});
  for (const std::int64_t utime : {30, 10, 20}) push(queue, 1, utime);
  EXPECT_EQ(drain(queue), (std::vector<Entry>{{10, 1}, {20, 1}, {30, 1}}));
}

/// Fifty rounds of arrival, where all clocks leap by `leap_us` after half a second.
void expect_the_same_in_any_order(std::int64_t leap_us) {
  std::vector<Entry> reference;
  std::mt19937_64 random(3);
  for (int round = 0; round < 50; ++round) {
    // kind 0 every 20 ms, kind 1 every 100 ms, the latter delayed by up to 40 ms either way
    std::vector<std::pair<std::int64_t, Entry>> arrivals;
    const std::int64_t delay_us = static_cast<std::int64_t>(random() % 80001) - 40000;
    for (int i = 0; i < 50; ++i) arrivals.push_back({i * 20000, {i * 20000, 0}});
    for (int i = 0; i < 10; ++i) arrivals.push_back({i * 100000 + delay_us, {i * 100000, 1}});
    std::stable_sort(arrivals.begin(), arrivals.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    Queue queue = two_kinds(50000);
    std::vector<Entry> out;
    for (const auto& [when, entry] : arrivals) {
      push(queue, entry.second, entry.first + (entry.first < 500'000 ? 0 : leap_us));
      for (const Entry& next : drain(queue)) out.push_back(next);
    }
    while (const auto entry = queue.pop_flushed()) out.push_back(*entry);
    EXPECT_TRUE(std::is_sorted(out.begin(), out.end()));
    if (round == 0) reference = out;
    EXPECT_EQ(out, reference) << "delay " << delay_us << " us, leap " << leap_us << " us";
  }
  EXPECT_EQ(reference.size(), 60u);
}

TEST(OrderedQueue, ArrivalOrderBetweenKindsWithinTheWaitDoesNotMatter) {
  expect_the_same_in_any_order(0);
}

TEST(OrderedQueue, NobodyHasWaitedWhereAllClocksAreSetBack) {
  // Set back by an hour and by a minute.
  for (const std::int64_t back_us : {3'600'000'000LL, 60'000'000LL}) {
    expect_the_same_in_any_order(kEpoch_us - back_us);
  }
}

}  // namespace
}  // namespace orchard::timing
