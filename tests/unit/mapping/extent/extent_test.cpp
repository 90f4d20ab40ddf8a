// SPDX-License-Identifier: BSD-3-Clause
// Which landmarks are parts of a bush: what certainly is no tree where the borders touch, what
// rather is none where it overlaps the bush.
#include "mapping/extent/extent.hpp"

#include <gtest/gtest.h>

namespace orchard::mapping {
namespace {

/// A bush 0.8 m wide at the origin, and something 0.1 m wide beside or in it.
std::int32_t bush_of(double x_m, float log_odds) {
  MapperConfig config;
  LandmarkTable landmarks;
  const auto add = [&](double at_m, double width_m, float odds, bool is_clump) {
    const std::int32_t index = landmarks.add({at_m, 0.0}, width_m);
    landmarks.change(index, [&](LandmarkRecord& r) {
      r.width_m = static_cast<float>(width_m);
      r.log_odds = odds;
      r.num_observations = r.num_all = 10;
      r.is_seen = true;
      r.is_clump = is_clump;
    });
    return index;
  };
  const std::int32_t bush = add(0.0, 0.8, -8.0f, true);
  const std::int32_t part = add(x_m, 0.1, log_odds, false);
  EXPECT_EQ(touching_clump(landmarks, bush, config) == part,
            touching_clump(landmarks, part, config) == bush);
  return touching_clump(landmarks, part, config);
}

TEST(Extent, WhatIsCertainlyNoTreeIsPartOfTheBushItTouches) {
  EXPECT_EQ(bush_of(0.5, -4.0f), 0);
  EXPECT_EQ(bush_of(0.7, -4.0f), -1);
}

TEST(Extent, InABushItIsEnoughToBeRatherNone) {
  EXPECT_EQ(bush_of(0.2, -0.5f), 0);
  EXPECT_EQ(bush_of(0.43, -0.5f), 0) << "they overlap";
  EXPECT_EQ(bush_of(0.47, -0.5f), -1) << "they only touch";
  EXPECT_EQ(bush_of(0.2, 0.5f), -1);
}

}  // namespace
}  // namespace orchard::mapping
