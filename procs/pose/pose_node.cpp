// SPDX-License-Identifier: BSD-3-Clause
#include "pose/pose_node.hpp"

#include <variant>

namespace orchard::procs {
namespace {

using pose::PoseMode;

bool uses_odometry(PoseMode mode) {
  return mode == PoseMode::kOdometry || mode == PoseMode::kFixesAndOdometry;
}
bool uses_fixes(PoseMode mode) {
  return mode == PoseMode::kFixes || mode == PoseMode::kFixesAndOdometry;
}

}  // namespace

PoseNode::PoseNode(const io::Config& config)
    : mode_(config.pose.mode),
      queue_(uses_odometry(mode_), uses_fixes(mode_), config.pose.reorder_window_s),
      estimator_(config.pose) {}

std::vector<bus::Channel> PoseNode::inputs() const {
  // A robot that stands still has nothing to say where it is; its scans say when it was there.
  if (mode_ == PoseMode::kStationary) return {bus::Channel::kScan};
  std::vector<bus::Channel> channels;
  if (uses_odometry(mode_)) channels.push_back(bus::Channel::kOdometry);
  if (uses_fixes(mode_)) channels.push_back(bus::Channel::kPoseFix);
  return channels;
}

void PoseNode::handle(const bus::Message& input, const bus::Outbox& send) {
  if (const auto* scan = std::get_if<laser::Scan>(&input)) {
    pose::PoseEstimate origin;
    origin.utime = scan->utime;
    send_pose(origin, send);
  } else if (const auto* odometry = std::get_if<pose::Odometry>(&input)) {
    queue_.push(*odometry);
  } else if (const auto* fix = std::get_if<pose::PoseFix>(&input)) {
    queue_.push(*fix);
  }
  while (const auto measurement = queue_.pop()) take(*measurement, send);
}

void PoseNode::flush(const bus::Outbox& send) {
  while (const auto measurement = queue_.pop_flushed()) take(*measurement, send);
}

void PoseNode::take(const pose::Measurement& measurement, const bus::Outbox& send) {
  std::visit([&](const auto& m) { estimator_.add(m); }, measurement);
  const std::optional<pose::PoseEstimate> estimate = estimator_.estimate();
  // Measurements of one time make one pose.
  if (estimate && !queue_.next_is_at(estimate->utime)) send_pose(*estimate, send);
}

void PoseNode::send_pose(pose::PoseEstimate estimate, const bus::Outbox& send) {
  estimate.seq = next_seq_++;
  send(estimate);
}

bus::NodeCounts PoseNode::counts() const {
  bus::NodeCounts counts;
  counts.num_late = queue_.num_late();
  return counts;
}

std::string PoseNode::waiting_for() const {
  const std::optional<std::size_t> channel = queue_.waits_for();
  if (!channel) return {};
  const bus::Channel missing = *channel == 0 ? bus::Channel::kOdometry : bus::Channel::kPoseFix;
  return "the pose at " + std::to_string(*queue_.next_utime()) + " us waits for " +
         std::string(bus::info(missing).name) + " of that time or later";
}

}  // namespace orchard::procs
