// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/position_mode.hpp"

#include <gtest/gtest.h>

namespace orchard::mapping {
namespace {

/// A mode that says of how many observations it is.
PositionMode made_of(std::int32_t num_observations) {
  return {{static_cast<double>(num_observations), 0.0}, Eigen::Matrix2d::Identity()};
}

TEST(ModeCache, AFewObservationsAreAlwaysTakenAnew) {
  ModeCache cache;
  for (std::int32_t n = 1; n <= 32; ++n) {
    EXPECT_EQ(cache.at(7, n, [&] { return made_of(n); }).p_map.x(), n);
  }
}

TEST(ModeCache, IsASixteenthBehindAtMostAndNeverManyObservations) {
  ModeCache cache;
  for (std::int32_t n = 1; n <= 3000; ++n) {
    const double of = cache.at(3, n, [&] { return made_of(n); }).p_map.x();
    EXPECT_GT(of, n - 32);
    EXPECT_GT(of, n - n / 16.0);
    EXPECT_LE(of, n);
  }
}

TEST(ModeCache, CostsNoMoreTheLongerALandmarkIsKnown) {
  ModeCache cache;
  int num_made = 0;
  int until_1000 = 0;
  for (std::int32_t n = 1; n <= 11000; ++n) {
    cache.at(0, n, [&] {
      ++num_made;
      return made_of(n);
    });
    if (n == 1000) until_1000 = num_made;
  }
  EXPECT_LE(num_made - until_1000, 10000 / 32 + 1);
}

TEST(ModeCache, ForgetsWhatItIsToldToAndKnowsLandmarksApart) {
  ModeCache cache;
  cache.at(2, 100, [] { return made_of(100); });
  cache.at(5, 101, [] { return made_of(101); });
  EXPECT_EQ(cache.at(2, 102, [] { return made_of(102); }).p_map.x(), 100);
  cache.forget(2);
  EXPECT_EQ(cache.at(2, 102, [] { return made_of(102); }).p_map.x(), 102);
  EXPECT_EQ(cache.at(5, 102, [] { return made_of(102); }).p_map.x(), 101);
  cache.forget(1000);
}

}  // namespace
}  // namespace orchard::mapping
