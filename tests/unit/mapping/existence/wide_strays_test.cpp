// SPDX-License-Identifier: BSD-3-Clause
// A single view of something that passes before a row, of any width: beams end at the trees beside
// it and tell of its ground.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "mapping/mapper.hpp"
#include "unit/mapping/existence/beam_world.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

/// What is detected in one scan only: one stands there in all scans, the other in none.
const Thing kBush{{5.0, -1.4}, 1.2}, kView{{5.0, 1.2}, 1.4};

/// A robot passes a row of trees at y = 2, a metre apart, at 1 m/s, ten scans a second.
Mapper drive() {
  std::vector<Thing> trees;
  for (int i = 0; i <= 10; ++i) trees.push_back({{1.0 * i, 2.0}});
  std::vector<Thing> things = trees;
  things.push_back(kBush);
  const laser::LaserConfig laser;
  Mapper mapper(MapperConfig{}, {laser.mount_x_m, laser.mount_y_m});
  for (int k = 0; k < 100; ++k) {
    pose::PoseEstimate pose;
    pose.utime = 1'000'000 + 100'000LL * k;
    pose.x_m = 0.1 * k;
    pose.covariance = {1e-6, 0, 0, 1e-6, 0, 1e-8};
    detection::Detections detections;
    detections.utime = pose.utime;
    const auto add = [&](const Thing& thing) {
      detection::Detection d;
      d.centre_x_m = thing.p.x() - pose.x_m;
      d.centre_y_m = thing.p.y();
      d.covariance = {1e-4, 0.0, 1e-4};
      d.width_m = thing.width_m;
      d.width_sd_m = 0.01;
      d.num_beams = 20;
      d.label = thing.width_m < 0.3 ? detection::Label::kTree : detection::Label::kObject;
      detections.trunks.push_back(d);
    };
    for (const Thing& tree : trees) {
      if ((tree.p - Vector2d(pose.x_m, 0.0)).norm() < 4.0) add(tree);
    }
    if (k == 30) {
      add(kBush);
      add(kView);
    }
    mapper.update(
        detections, pose,
        std::make_shared<FreeSpace>(beams_of(things, pose, laser), laser, laser::BlindSector{}));
  }
  return mapper;
}

TEST(WideStrays, GroundThatScansSawFreeIsThatOfNothing) {
  const Mapper mapper = drive();
  const std::vector<std::int32_t> strays = mapper.spurious_ids(*mapper.ground());
  int num_trees = 0, num_bushes = 0, num_views = 0;
  for (const Landmark& l : mapper.landmarks()) {
    const bool is_stray = std::binary_search(strays.begin(), strays.end(), l.id);
    if (l.width_m < 0.3) {
      ++num_trees;
      EXPECT_FALSE(is_stray) << l.x_m;
    } else if (l.y_m < 0.0) {
      ++num_bushes;
      EXPECT_FALSE(is_stray) << "the bush";
    } else {
      ++num_views;
      EXPECT_TRUE(is_stray) << "the view";
    }
  }
  EXPECT_EQ(num_trees, 11);
  EXPECT_EQ(num_bushes, 1);
  EXPECT_EQ(num_views, 1);
}

}  // namespace
}  // namespace orchard::mapping
