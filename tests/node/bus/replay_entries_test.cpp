// SPDX-License-Identifier: BSD-3-Clause
#include "bus/replay/replay_entries.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace orchard::bus {
namespace {

void expect_the_same(const ReplayEntries& entries, const std::vector<ReplayEntry>& told) {
  ASSERT_EQ(entries.size(), told.size());
  std::size_t i = 0;
  for (const ReplayEntry& entry : entries) {
    ASSERT_LT(i, told.size());
    EXPECT_EQ(entry.utime, told[i].utime);
    EXPECT_EQ(entry.channel, told[i].channel);
    EXPECT_EQ(entry.seq, told[i].seq);
    EXPECT_EQ(entry.offset, told[i].offset);
    ++i;
  }
  EXPECT_EQ(i, told.size());
}

TEST(ReplayEntries, ReadAsTheyWereTold) {
  std::mt19937_64 random(1);
  ReplayEntries entries;
  std::vector<ReplayEntry> told;
  EXPECT_TRUE(entries.empty());
  expect_the_same(entries, told);
  const auto tell = [&](const ReplayEntry& entry) {
    entries.push_back(entry);
    told.push_back(entry);
  };
  for (int i = 0; i < 2000; ++i) {  // any value beside any other
    tell({static_cast<std::int64_t>(random()), static_cast<Channel>(random() % kNumChannels),
          static_cast<std::int32_t>(random()), random()});
  }
  for (const std::int64_t utime : {std::numeric_limits<std::int64_t>::min(), std::int64_t{0},
                                   std::numeric_limits<std::int64_t>::max()}) {
    tell({utime, Channel::kScan, std::numeric_limits<std::int32_t>::min(),
          std::numeric_limits<std::uint64_t>::max()});
    tell({utime, Channel::kScan, std::numeric_limits<std::int32_t>::max(), 0});
  }
  expect_the_same(entries, told);
  entries.shrink_to_fit();
  expect_the_same(entries, told);
}

}  // namespace
}  // namespace orchard::bus
