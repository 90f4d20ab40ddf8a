// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scene/tube_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/angles.hpp"
#include "unit/simulation/rig.hpp"

namespace orchard::simulation {
namespace {

TEST(TubeScene, IsThePapers) {
  const Scene scene = make_tube_scene(7, test_rig());
  ASSERT_EQ(scene.truth.size(), 16u);
  ASSERT_EQ(scene.world.cylinders.size(), 16u);
  for (int i = 0; i < 12; ++i) {
    EXPECT_EQ(scene.truth[i].name, "T" + std::to_string(i + 1));
    EXPECT_EQ(scene.truth[i].label, detection::Label::kTree);
    EXPECT_DOUBLE_EQ(scene.truth[i].width_m, 0.090);
    EXPECT_DOUBLE_EQ(scene.world.cylinders[i].height_m, 0.500);
    EXPECT_EQ(scene.truth[i].x_m > 0.0, i >= 6);
    EXPECT_NEAR(std::abs(scene.truth[i].x_m), 0.8, 0.041);
    const double hue_deg = scene.world.cylinders[i].appearance.hue_deg;
    EXPECT_GT(hue_deg, 17.6);
    EXPECT_LT(hue_deg, 44.6);
    if (i % 6 > 0) {
      EXPECT_NEAR(scene.truth[i].y_m - scene.truth[i - 1].y_m, 1.0, 0.081);
    }
  }
  for (int i = 12; i < 16; ++i) {
    EXPECT_EQ(scene.truth[i].name, "B" + std::to_string(i - 11));
    EXPECT_EQ(scene.truth[i].label, detection::Label::kObject);
    EXPECT_DOUBLE_EQ(scene.truth[i].width_m, i == 13 ? 0.090 : 0.170);
  }
  EXPECT_GT(scene.world.cylinders[13].appearance.hue_deg, 90.0);  // B2, another colour
}

TEST(TubeScene, RobotGoesMidwayInEqualSteps) {
  const Scene scene = make_tube_scene(7, test_rig());
  ASSERT_TRUE(scene.stepped);
  for (std::size_t i = 0; i < scene.stops.size(); ++i) {
    EXPECT_DOUBLE_EQ(scene.stops[i].x_m, 0.0);
    EXPECT_NEAR(scene.stops[i].y_m, 0.4 * static_cast<double>(i), 1e-12);
    EXPECT_DOUBLE_EQ(scene.stops[i].yaw_rad, geometry::kPi / 2.0);
  }
}

TEST(TubeScene, EverythingIsInFiveToEightPairs) {
  const RigConfig rig = test_rig();
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const Scene scene = make_tube_scene(seed, rig);
    const std::vector<int> pairs = count_pairs(scene, rig, 4.0);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      EXPECT_GE(pairs[i], 5) << "seed " << seed << " " << scene.truth[i].name;
      EXPECT_LE(pairs[i], 8) << "seed " << seed << " " << scene.truth[i].name;
    }
  }
}

TEST(TubeScene, NothingStandsInAnotherOrInTheRobotsWay) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Scene scene = make_tube_scene(seed, test_rig());
    for (std::size_t i = 0; i < scene.truth.size(); ++i) {
      EXPECT_GT(std::abs(scene.truth[i].x_m) - 0.5 * scene.truth[i].width_m, 0.2);
      for (std::size_t j = 0; j < i; ++j) {
        const double gap_m = std::hypot(scene.truth[i].x_m - scene.truth[j].x_m,
                                        scene.truth[i].y_m - scene.truth[j].y_m) -
                             0.5 * (scene.truth[i].width_m + scene.truth[j].width_m);
        EXPECT_GT(gap_m, 0.05) << "seed " << seed;
      }
    }
  }
}

}  // namespace
}  // namespace orchard::simulation
