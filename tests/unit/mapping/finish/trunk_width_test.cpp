// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/finish/trunk_width.hpp"

#include <gtest/gtest.h>

#include <random>

namespace orchard::mapping {
namespace {

Landmark thing(double width_m, int row = 0, int num_observations = 20) {
  Landmark l;
  l.width_m = width_m;
  l.row = row;
  l.num_observations = num_observations;
  return l;
}

/// Trunks of 0.12 +- 0.015 m.
std::vector<Landmark> trunks(int num, int row = 0) {
  std::mt19937 random(5);
  std::normal_distribution<double> width_m(0.12, 0.015);
  std::vector<Landmark> landmarks;
  for (int i = 0; i < num; ++i) landmarks.push_back(thing(width_m(random), row));
  return landmarks;
}

TEST(TrunkWidth, IsThatOfMostThings) {
  std::vector<Landmark> landmarks = trunks(60);
  for (const double width_m : {0.02, 0.03, 0.5, 0.6, 0.7, 0.9}) landmarks.push_back(thing(width_m));
  Landmark hedge = thing(0.3);
  hedge.length_m = 8.0;
  landmarks.push_back(hedge);
  for (int i = 0; i < 300; ++i) landmarks.push_back(thing(0.04, 0, 2));  // seen in passing
  const auto width = trunk_width_of(landmarks);
  ASSERT_TRUE(width);
  EXPECT_EQ(width->num_trunks, 60);
  EXPECT_NEAR(width->mean_m, 0.12, 0.008);
  EXPECT_NEAR(width->sd_m, 0.015, 0.005);
  EXPECT_NEAR(width->mean_se_m, 0.015 / std::sqrt(60.0), 0.001);
}

TEST(TrunkWidth, WhatStandsInRowsCountsBeforeWhatIsFrequent) {
  std::vector<Landmark> landmarks = trunks(20, 1);
  for (int i = 0; i < 100; ++i) landmarks.push_back(thing(0.03));
  ASSERT_TRUE(trunk_width_of(landmarks));
  EXPECT_NEAR(trunk_width_of(landmarks)->mean_m, 0.12, 0.01);
}

TEST(TrunkWidth, ThingsOfAnyWidthHaveNone) {
  std::vector<Landmark> landmarks;
  for (int i = 0; i < 60; ++i) landmarks.push_back(thing(0.01 * std::pow(100.0, i / 59.0)));
  EXPECT_FALSE(trunk_width_of(landmarks));
  EXPECT_FALSE(trunk_width_of(trunks(7)));
  EXPECT_FALSE(trunk_width_of({}));
}

}  // namespace
}  // namespace orchard::mapping
