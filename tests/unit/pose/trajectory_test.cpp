// SPDX-License-Identifier: BSD-3-Clause
#include "pose/pose_estimate.hpp"

#include <gtest/gtest.h>

namespace orchard::pose {
namespace {

Trajectory trajectory_of(std::int32_t revision, int num_poses) {
  Trajectory trajectory;
  trajectory.utime = 1000;
  trajectory.revision = revision;
  for (int i = 0; i < num_poses; ++i) {
    PoseEstimate pose;
    pose.utime = 10 * i;
    pose.x_m = 0.5 * i;
    trajectory.poses.push_back(pose);
  }
  return trajectory;
}

TEST(Trajectory, PagesComeTogetherAgainWhateverTheNumberOfPoses) {
  for (const int num_poses : {0, 1, 6, 7, 8, 13, 14, 15}) {
    const auto pages = paginate(trajectory_of(3, num_poses), 7);
    EXPECT_EQ(pages.size(), static_cast<std::size_t>(num_poses <= 7 ? 1 : num_poses <= 14 ? 2 : 3));
    TrajectoryCollector collector;
    std::optional<Trajectory> whole;
    for (const TrajectoryPage& page : pages) {
      EXPECT_FALSE(whole);
      EXPECT_LE(page.poses.size(), 7u);
      whole = collector.add(page);
    }
    ASSERT_TRUE(whole);
    EXPECT_EQ(whole->revision, 3);
    EXPECT_EQ(whole->utime, 1000);
    ASSERT_EQ(whole->poses.size(), static_cast<std::size_t>(num_poses));
    for (int i = 0; i < num_poses; ++i) {
      EXPECT_EQ(whole->poses[static_cast<std::size_t>(i)].x_m, 0.5 * i);
    }
    EXPECT_EQ(collector.num_incomplete(), 0);
  }
}

TEST(Trajectory, ARevisionThatLostAPageIsDroppedAndTheNextOneTaken) {
  for (const std::size_t lost : {0u, 1u, 2u}) {
    TrajectoryCollector collector;
    const auto pages = paginate(trajectory_of(1, 20), 7);
    for (std::size_t i = 0; i < pages.size(); ++i) {
      if (i == lost) continue;
      EXPECT_FALSE(collector.add(pages[i]));
    }
    std::optional<Trajectory> whole;
    for (const TrajectoryPage& page : paginate(trajectory_of(2, 20), 7)) {
      whole = collector.add(page);
    }
    ASSERT_TRUE(whole) << "lost page " << lost;
    EXPECT_EQ(whole->revision, 2);
    EXPECT_EQ(whole->poses.size(), 20u);
    EXPECT_EQ(collector.num_incomplete(), 1) << "lost page " << lost;
  }
}

TEST(Trajectory, PagesThatDoNotFollowEachOtherInTimeAreNotJoined) {
  auto pages = paginate(trajectory_of(1, 14), 7);
  for (PoseEstimate& pose : pages[1].poses) pose.utime -= 50;
  TrajectoryCollector collector;
  EXPECT_FALSE(collector.add(pages[0]));
  EXPECT_FALSE(collector.add(pages[1]));
  EXPECT_EQ(collector.num_incomplete(), 1);
}

}  // namespace
}  // namespace orchard::pose
