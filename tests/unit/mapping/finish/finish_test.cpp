// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/finish/finish.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

#include "../rows/planted_rows.hpp"
#include "mapping/mapper.hpp"

namespace orchard::mapping {
namespace {

using detection::Label;

/// A map of six rows of twelve trunks, seen five times; the fifth of the second row as foliage.
Mapper mapped(bool has_camera) {
  MapperConfig config;
  config.has_camera = has_camera;
  Mapper mapper(config);
  test::Plan plan;
  plan.num_rows = 6;
  plan.num_places = 12;
  plan.missing = plan.post_fraction = 0.0;
  std::mt19937_64 random(1);
  const test::Planted block = test::plant(plan, random);
  for (int scan = 0; scan < 5; ++scan) {
    detection::Detections seen;
    seen.utime = 100'000 * scan;
    for (const Landmark& tree : block.landmarks) {
      const bool is_hidden = block.numbers.at(tree.id) == std::make_pair(2, 5);
      detection::Detection& d = seen.trunks.emplace_back();
      d.centre_x_m = tree.x_m;
      d.centre_y_m = tree.y_m;
      d.covariance = {4e-4, 0.0, 4e-4};
      d.width_m = is_hidden ? 0.5 : 0.1;
      d.width_sd_m = 0.01;
      d.label = is_hidden ? Label::kObject : Label::kTree;
      d.roc_tree = is_hidden ? 0.01f : 0.9f;
    }
    mapper.update(seen, {});
  }
  return mapper;
}

/// The one whose views looked least like a trunk.
const Landmark& hidden_one(const FinishedMap& map) {
  return *std::min_element(
      map.landmarks.begin(), map.landmarks.end(),
      [](const Landmark& a, const Landmark& b) { return a.roc_mean < b.roc_mean; });
}

TEST(Finish, ByALaserAloneFoliageInAGapOfItsRowIsItsTree) {
  const FinishedMap map = finish(mapped(false), {});
  const Landmark& hidden = hidden_one(map);
  EXPECT_EQ(hidden.label, Label::kTree);
  EXPECT_GT(hidden.probability, 0.9);
  EXPECT_EQ(hidden.width_m, 0.0) << "what was seen is no trunk";
  EXPECT_EQ(map.hidden_tree_ids, std::vector<std::int32_t>{hidden.id});
  ASSERT_EQ(map.rows.size(), 6u);
  EXPECT_GT(hidden.row, 0);
  EXPECT_GT(hidden.position, 0);
  for (const Row& row : map.rows) EXPECT_EQ(row.places.size(), 12u);
}

TEST(Finish, WhatACameraCallsAnObjectStaysOne) {
  const FinishedMap map = finish(mapped(true), {});
  const Landmark& object = hidden_one(map);
  EXPECT_EQ(object.label, Label::kObject);
  EXPECT_EQ(object.row, 0);
  ASSERT_EQ(map.rows.size(), 6u);
}

}  // namespace
}  // namespace orchard::mapping
