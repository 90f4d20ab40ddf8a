// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/node/node.hpp"

namespace orchard::bus::testing {

/// One detection per scan, sent when the next scan comes: so that a flush has something to send.
class FakeDetector : public Node {
 public:
  std::string_view name() const override { return "detector"; }
  std::vector<Channel> inputs() const override { return {Channel::kScan, Channel::kImage}; }
  void handle(const Message& input, const Outbox& send) override {
    if (std::holds_alternative<vision::Image>(input)) {
      ++num_images_;
      return;
    }
    flush(send);
    const auto& scan = std::get<laser::Scan>(input);
    detection::Detection trunk;
    trunk.utime = scan.utime;
    trunk.range_m = scan.ranges_m.front();
    detection::Detections detections;
    detections.utime = scan.utime;
    detections.trunks.assign(static_cast<std::size_t>(scan.seq % 3), trunk);
    held_ = detections;
  }
  void flush(const Outbox& send) override {
    if (!held_) return;
    held_->seq = next_seq_++;
    send(*held_);
    held_.reset();
  }

 private:
  int num_images_ = 0;
  std::int32_t next_seq_ = 0;
  std::optional<detection::Detections> held_;
};

/// A pose per odometry message: x is the distance driven.
class FakePose : public Node {
 public:
  std::string_view name() const override { return "pose"; }
  std::vector<Channel> inputs() const override { return {Channel::kOdometry}; }
  void handle(const Message& input, const Outbox& send) override {
    const auto& odometry = std::get<pose::Odometry>(input);
    x_m_ += odometry.speed_mps * 0.02;
    pose::PoseEstimate estimate;
    estimate.utime = odometry.utime;
    estimate.seq = next_seq_++;
    estimate.x_m = x_m_;
    send(estimate);
  }
  void flush(const Outbox&) override {}

 private:
  double x_m_ = 0.0;
  std::int32_t next_seq_ = 0;
};

/// A tile per DETECTIONS, once a POSE at or after it is known; also depends on the order.
class FakeMapper : public Node {
 public:
  std::string_view name() const override { return "mapper"; }
  std::vector<Channel> inputs() const override { return {Channel::kDetections, Channel::kPose}; }
  void handle(const Message& input, const Outbox& send) override {
    if (const auto* estimate = std::get_if<pose::PoseEstimate>(&input)) {
      poses_[estimate->utime] = estimate->x_m;
    } else {
      const auto& detections = std::get<detection::Detections>(input);
      waiting_[detections.utime] = detections;
    }
    release(send, false);
  }
  void flush(const Outbox& send) override { release(send, true); }

 private:
  void release(const Outbox& send, bool all) {
    while (!waiting_.empty()) {
      const auto& detections = waiting_.begin()->second;
      const auto after = poses_.lower_bound(detections.utime);
      if (after == poses_.end() && !all) return;
      total_ += static_cast<std::int32_t>(detections.trunks.size());
      mapping::MapTile tile;
      tile.utime = detections.utime;
      tile.seq = next_seq_++;
      tile.num_landmarks_total = total_;
      mapping::Landmark landmark;
      landmark.x_m = after == poses_.end() ? -1.0 : after->second;
      tile.landmarks = {landmark};
      send(tile);
      waiting_.erase(waiting_.begin());
    }
  }
  std::map<std::int64_t, double> poses_;
  std::map<std::int64_t, detection::Detections> waiting_;
  std::int32_t total_ = 0;
  std::int32_t next_seq_ = 0;
};

inline std::unique_ptr<Node> make_fake_node(const std::string& role) {
  if (role == "detector") return std::make_unique<FakeDetector>();
  if (role == "pose") return std::make_unique<FakePose>();
  return std::make_unique<FakeMapper>();
}

}  // namespace orchard::bus::testing
