// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/map_state.hpp"

#include <gtest/gtest.h>

namespace orchard::mapping {
namespace {

using Indices = std::vector<std::int32_t>;

/// Of observations that were of `then_of` and are of `now_of`.
Indices kept(const Indices& then_of, const Indices& now_of, std::int32_t num_now,
             std::int32_t first_unused) {
  const auto thens = [&](std::int32_t now) {
    Indices all;
    for (std::size_t k = 0; k < now_of.size(); ++k) {
      if (now_of[k] == now) all.push_back(then_of[k]);
    }
    return all;
  };
  return keep_indices(thens, num_now, first_unused);
}

TEST(IdKeeping, TheLargestFractionOfObservationsDecides) {
  // new 0 has two observations of then 4 and one of then 2; new 1 has three of then 2
  EXPECT_EQ(kept({4, 4, 2, 2, 2, 2}, {0, 0, 0, 1, 1, 1}, 2, 5), (Indices{4, 2}));
}

TEST(IdKeeping, WhatWasSplitKeepsTheIdOnceAndTheOtherHalfGetsANewOne) {
  EXPECT_EQ(kept({3, 3, 3, 3, 3}, {0, 0, 1, 1, 1}, 2, 7), (Indices{7, 3}));
}

TEST(IdKeeping, WhatWasMergedKeepsTheIdOfTheLargerPart) {
  EXPECT_EQ(kept({0, 1, 1}, {0, 0, 0}, 1, 2), (Indices{1}));
}

TEST(IdKeeping, EqualSharesGoToTheLowerIndices) {
  EXPECT_EQ(kept({0, 1, 0, 1}, {0, 0, 1, 1}, 2, 2), (Indices{0, 1}));
}

TEST(IdKeeping, NoIndexIsGivenTwiceAndNewOnesWereNeverUsed) {
  // observation 2 belonged to none before; new 2 has no observation any more
  EXPECT_EQ(kept({0, 0, -1}, {1, 1, 0}, 3, 9), (Indices{9, 0, -1}));
}

}  // namespace
}  // namespace orchard::mapping
