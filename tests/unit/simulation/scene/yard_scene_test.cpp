// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scene/yard/yard_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/angles.hpp"

namespace orchard::simulation {
namespace {

std::vector<Pose2> way_of(const Scene& scene) {
  std::vector<Pose2> way;
  for (double s = 0.0; s <= scene.path.duration_s(); s += 0.5) way.push_back(scene.path.pose_at(s));
  return way;
}

TEST(YardScene, GivesRoomToARobotOnItsWay) {
  constexpr double kRobot_m = 0.6;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Scene scene = make_yard_scene(seed, {});
    EXPECT_NEAR(scene.path.length_m(), 1500.0, 60.0);
    for (const Pose2& pose : way_of(scene)) {
      for (const Cylinder& c : scene.world.cylinders) {
        ASSERT_GT(std::hypot(c.x_m - pose.x_m, c.y_m - pose.y_m), c.radius_m + kRobot_m)
            << "seed " << seed << " at " << pose.x_m << ", " << pose.y_m;
      }
      for (const Box& b : scene.world.boxes) {
        const Pose2 in_box = between(Pose2{b.x_m, b.y_m, b.yaw_rad}, pose);
        const double dx = std::abs(in_box.x_m) - 0.5 * b.length_m;
        const double dy = std::abs(in_box.y_m) - 0.5 * b.width_m;
        ASSERT_GT(std::hypot(std::max(dx, 0.0), std::max(dy, 0.0)), kRobot_m) << "seed " << seed;
      }
    }
  }
}

TEST(YardScene, ComesBackToPlacesInBothDirections) {
  const std::vector<Pose2> way = way_of(make_yard_scene(1, {}));
  int num_same = 0, num_opposite = 0;
  for (std::size_t i = 0; i < way.size(); ++i) {
    for (std::size_t j = 0; j + 100 < i; ++j) {
      if (std::hypot(way[i].x_m - way[j].x_m, way[i].y_m - way[j].y_m) > 3.0) continue;
      const double turn_rad = std::abs(geometry::wrap_angle_rad(way[i].yaw_rad - way[j].yaw_rad));
      num_same += turn_rad < 0.5;
      num_opposite += turn_rad > 2.6;
    }
  }
  EXPECT_GT(num_same, 100);
  EXPECT_GT(num_opposite, 100);
}

TEST(YardScene, IsTheSameAgainForASeedAndAnotherForAnother) {
  const Scene one = make_yard_scene(3, {}), again = make_yard_scene(3, {});
  const Scene other = make_yard_scene(4, {});
  ASSERT_EQ(one.truth.size(), again.truth.size());
  for (std::size_t i = 0; i < one.truth.size(); ++i) {
    EXPECT_EQ(one.truth[i].x_m, again.truth[i].x_m);
  }
  EXPECT_NE(one.truth.front().x_m, other.truth.front().x_m);
  EXPECT_EQ(static_cast<std::size_t>(one.world.num_targets), one.truth.size());
}

}  // namespace
}  // namespace orchard::simulation
