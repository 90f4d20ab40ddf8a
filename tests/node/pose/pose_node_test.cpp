// SPDX-License-Identifier: BSD-3-Clause
#include "pose/pose_node.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace orchard::procs {
namespace {

io::Config config_of(pose::PoseMode mode) {
  io::Config config;
  config.pose.mode = mode;
  config.pose.reorder_window_s = 0.05;
  return config;
}

std::vector<pose::PoseEstimate> run(const io::Config& config,
                                    const std::vector<bus::Message>& inputs) {
  PoseNode node(config);
  std::vector<pose::PoseEstimate> poses;
  const bus::Outbox send = [&](bus::Message m) {
    if (const auto* pose = std::get_if<pose::PoseEstimate>(&m)) poses.push_back(*pose);
  };
  for (const bus::Message& input : inputs) node.handle(input, send);
  node.flush(send);
  return poses;
}

/// Odometry at 50 Hz and a fix per 200 ms of a robot that drives a straight line at 1 m/s.
std::vector<bus::Message> straight_drive() {
  std::vector<bus::Message> messages;
  for (int i = 0; i <= 100; ++i) {
    pose::Odometry odometry;
    odometry.utime = i * 20000;
    odometry.seq = i;
    odometry.speed_mps = 1.0;
    messages.emplace_back(odometry);
    if (i % 10 != 0) continue;
    pose::PoseFix fix;
    fix.utime = i * 20000;
    fix.seq = i / 10;
    fix.x_m = i * 0.020;
    messages.emplace_back(fix);
  }
  return messages;
}

TEST(PoseNode, OnePosePerTimeInOrderAlongTheTrueLine) {
  const auto poses = run(config_of(pose::PoseMode::kFixesAndOdometry), straight_drive());
  ASSERT_EQ(poses.size(), 101u);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(poses[i].seq, static_cast<std::int32_t>(i));
    EXPECT_NEAR(poses[i].x_m, poses[i].utime * 1e-6, 1e-9);
    EXPECT_NEAR(poses[i].yaw_rad, 0.0, 1e-9);
  }
}

TEST(PoseNode, ArrivalOrderBetweenChannelsDoesNotMatter) {
  const std::vector<bus::Message> messages = straight_drive();
  const auto reference = run(config_of(pose::PoseMode::kFixesAndOdometry), messages);
  std::mt19937_64 random(5);
  for (int round = 0; round < 20; ++round) {
    // fixes lag or lead odometry by up to 40 ms: less than the window
    std::vector<std::pair<std::int64_t, bus::Message>> arrivals;
    for (const bus::Message& m : messages) {
      const bool is_fix = std::holds_alternative<pose::PoseFix>(m);
      const std::int64_t delay_us =
          is_fix ? static_cast<std::int64_t>(random() % 80001) - 40000 : 0;
      arrivals.emplace_back(bus::utime_of(m) + delay_us, m);
    }
    std::stable_sort(arrivals.begin(), arrivals.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<bus::Message> shuffled;
    for (const auto& arrival : arrivals) shuffled.push_back(arrival.second);
    const auto poses = run(config_of(pose::PoseMode::kFixesAndOdometry), shuffled);
    ASSERT_EQ(poses.size(), reference.size());
    for (std::size_t i = 0; i < poses.size(); ++i) {
      EXPECT_EQ(poses[i].utime, reference[i].utime);
      EXPECT_EQ(poses[i].x_m, reference[i].x_m);
      EXPECT_EQ(poses[i].covariance, reference[i].covariance);
    }
  }
}

/// Ten metres to the east, and five fixes a second of a receiver: in order of time.
std::vector<bus::Message> drive_under_satellites() {
  std::vector<bus::Message> messages;
  for (int i = 0; i <= 500; ++i) {
    pose::Odometry odometry;
    odometry.utime = i * 20000;
    odometry.seq = i;
    odometry.speed_mps = 1.0;
    messages.emplace_back(odometry);
    if (i % 10 != 0) continue;
    pose::Gnss fix;
    fix.utime = i * 20000 + 3000;
    fix.seq = i / 10;
    fix.latitude_deg = -27.6;
    fix.longitude_deg = 151.9 + 0.02 * i / (111320.0 * std::cos(27.6 * 0.017453292519943295));
    fix.covariance = {4e-4, 0, 0, 4e-4, 0, 1e-3};
    fix.fix_quality = 4;
    messages.emplace_back(fix);
  }
  return messages;
}

TEST(PoseNode, FixesOfAReceiverThatTakesItsTimeAreUsedLikePunctualOnes) {
  io::Config config = config_of(pose::PoseMode::kFused);
  config.pose.reorder_window_s = 0.02;
  const std::vector<bus::Message> in_order = drive_under_satellites();
  const auto reference = run(config, in_order);
  ASSERT_GT(reference.size(), 400u);
  for (const std::int64_t latency_us : {50'000, 120'000, 250'000, 450'000}) {
    std::vector<std::pair<std::int64_t, bus::Message>> arrivals;
    for (const bus::Message& m : in_order) {
      const bool is_fix = std::holds_alternative<pose::Gnss>(m);
      arrivals.emplace_back(bus::utime_of(m) + (is_fix ? latency_us : 0), m);
    }
    std::stable_sort(arrivals.begin(), arrivals.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    PoseNode node(config);
    std::vector<pose::PoseEstimate> poses;
    const bus::Outbox send = [&](bus::Message m) {
      if (const auto* pose = std::get_if<pose::PoseEstimate>(&m)) poses.push_back(*pose);
    };
    for (const auto& arrival : arrivals) node.handle(arrival.second, send);
    EXPECT_EQ(node.counts().num_late, 0) << latency_us;
    node.flush(send);
    ASSERT_EQ(poses.size(), reference.size()) << latency_us;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      ASSERT_EQ(poses[i].utime, reference[i].utime);
      ASSERT_EQ(poses[i].x_m, reference[i].x_m) << latency_us << " " << i;
    }
  }
}

TEST(PoseNode, AStationaryRobotIsAtTheOriginForEveryScan) {
  laser::Scan scan;
  scan.utime = 77;
  const auto poses = run(config_of(pose::PoseMode::kStationary), {scan});
  ASSERT_EQ(poses.size(), 1u);
  EXPECT_EQ(poses[0].utime, 77);
  EXPECT_EQ(poses[0].x_m, 0.0);
}

/// Truth: the rule of trajectory_t that a correction holds for POSE before its utime.
TEST(PoseNode, TheCorrectionAtTheEndHoldsForTheLastPose) {
  PoseNode node(config_of(pose::PoseMode::kSlam));
  std::int64_t last_pose_utime = 0, last_page_utime = 0;
  const bus::Outbox send = [&](bus::Message m) {
    if (const auto* pose = std::get_if<pose::PoseEstimate>(&m)) last_pose_utime = pose->utime;
    if (const auto* page = std::get_if<pose::TrajectoryPage>(&m)) last_page_utime = page->utime;
  };
  for (const bus::Message& input : straight_drive()) {
    node.handle(input, send);
    const auto* odometry = std::get_if<pose::Odometry>(&input);
    if (!odometry || odometry->seq % 10 != 0) continue;
    detection::Detections seen;
    seen.utime = odometry->utime;
    seen.seq = odometry->seq / 10;
    node.handle(seen, send);
  }
  node.flush(send);
  EXPECT_GT(last_pose_utime, 0);
  EXPECT_GT(last_page_utime, last_pose_utime);
}

TEST(PoseNode, SaysWhatItWaitsFor) {
  PoseNode node(config_of(pose::PoseMode::kFixesAndOdometry));
  pose::Odometry odometry;
  odometry.utime = 10;
  node.handle(odometry, [](bus::Message) {});
  EXPECT_NE(node.waiting_for().find("POSE_FIX"), std::string::npos);
}

}  // namespace
}  // namespace orchard::procs
