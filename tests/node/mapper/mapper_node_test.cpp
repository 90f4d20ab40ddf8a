// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/mapper_node.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "bus/codec.hpp"

namespace orchard::procs {
namespace {

constexpr std::int64_t kStart_us = 1000000;

pose::PoseEstimate pose_at(int k, std::int64_t utime) {
  pose::PoseEstimate pose;
  pose.utime = utime;
  pose.seq = k;
  pose.x_m = 1e-6 * static_cast<double>(utime - kStart_us);
  return pose;
}

detection::Detections scan_at(int k, std::int64_t utime) {
  detection::Detections detections;
  detections.utime = utime;
  detections.seq = k;
  for (int tree = 0; tree < 4; ++tree) {
    detection::Detection d;
    d.centre_x_m = tree - 1e-6 * static_cast<double>(utime - kStart_us) + 0.001 * (k % 5);
    d.centre_y_m = 1.0;
    d.covariance = {1e-4, 0, 1e-4};
    d.width_m = 0.09;
    d.width_sd_m = 0.01;
    d.label = detection::Label::kTree;
    d.roc_tree = 0.9f;
    detections.trunks.push_back(d);
  }
  return detections;
}

std::vector<std::vector<std::uint8_t>> run(const std::vector<bus::Message>& inputs) {
  MapperNode node{io::Config{}};
  std::vector<std::vector<std::uint8_t>> out;
  const bus::Outbox send = [&](bus::Message m) { out.push_back(bus::encode(m)); };
  for (const bus::Message& input : inputs) node.handle(input, send);
  node.flush(send);
  EXPECT_EQ(node.counts().num_late, 0);
  EXPECT_EQ(node.landmarks().size(), 4u);
  EXPECT_EQ(node.content({}).trajectory.size(), 30u);
  return out;
}

TEST(MapperNode, TheOrderOfArrivalBetweenChannelsDoesNotMatter) {
  std::vector<bus::Message> poses, scans;
  for (int k = 0; k < 30; ++k) {
    poses.push_back(pose_at(k, kStart_us + 100000 * k));
    scans.push_back(scan_at(k, kStart_us + 100000 * k - 30000 * (k > 0)));
  }
  const auto merge = [&](const std::vector<bool>& pose_first) {
    std::vector<bus::Message> all;
    std::size_t p = 0, s = 0;
    for (const bool is_pose : pose_first) {
      all.push_back(is_pose ? poses[p++] : scans[s++]);
    }
    return all;
  };
  std::vector<bool> order(60, false);
  std::fill(order.begin(), order.begin() + 30, true);
  const auto expected = run(merge(order));
  std::mt19937_64 bits(3);
  for (int round = 0; round < 50; ++round) {
    for (std::size_t i = order.size() - 1; i > 0; --i) {
      const std::size_t j = bits() % (i + 1);
      const bool held = order[i];
      order[i] = order[j];
      order[j] = held;
    }
    EXPECT_EQ(run(merge(order)), expected);
  }
}

TEST(MapperNode, WaitsForAPoseAndGivesUpByMessageTime) {
  io::Config config;
  config.mapper.pose_wait_s = 1.0;
  MapperNode node(config);
  int num_tiles = 0;
  const bus::Outbox send = [&](const bus::Message&) { ++num_tiles; };
  node.handle(scan_at(0, kStart_us), send);
  EXPECT_EQ(num_tiles, 0);
  EXPECT_NE(node.waiting_for().find("POSE"), std::string::npos);
  node.handle(scan_at(1, kStart_us + 2000000), send);
  EXPECT_EQ(node.counts().num_late, 1);
  node.handle(pose_at(0, kStart_us + 1900000), send);
  EXPECT_EQ(num_tiles, 0);
  node.handle(pose_at(1, kStart_us + 2100000), send);
  EXPECT_EQ(num_tiles, 1);
  EXPECT_TRUE(node.waiting_for().empty());
  node.handle(scan_at(2, kStart_us), send);
  EXPECT_EQ(node.counts().num_late, 2);
}

TEST(MapperNode, TilesStayBelowTheSizeOfADatagram) {
  MapperNode node{io::Config{}};
  std::size_t largest = 0;
  std::size_t num_landmarks = 0;
  const bus::Outbox send = [&](const bus::Message& m) {
    largest = std::max(largest, bus::encode(m).size());
    num_landmarks += std::get<mapping::MapTile>(m).landmarks.size();
  };
  detection::Detections many = scan_at(0, kStart_us);
  many.trunks.assign(1200, many.trunks.front());
  for (std::size_t i = 0; i < many.trunks.size(); ++i) {
    many.trunks[i].centre_x_m = static_cast<double>(i % 40);
    many.trunks[i].centre_y_m = static_cast<double>(i / 40);
  }
  node.handle(many, send);
  node.handle(pose_at(0, kStart_us), send);
  EXPECT_EQ(num_landmarks, 1200u);
  EXPECT_LT(largest, 60000u);
}

}  // namespace
}  // namespace orchard::procs
