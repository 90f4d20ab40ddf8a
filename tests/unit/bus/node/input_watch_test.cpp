// SPDX-License-Identifier: BSD-3-Clause
#include "bus/node/input_watch.hpp"

#include <gtest/gtest.h>

namespace orchard::bus {
namespace {

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

}  // namespace
}  // namespace orchard::bus
