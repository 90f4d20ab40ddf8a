// SPDX-License-Identifier: BSD-3-Clause
#include "pose/pose_node.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <variant>

#include "io/map/prior_map_file.hpp"
#include "pose/localiser.hpp"
#include "pose/pose_config.hpp"

namespace orchard::procs {
namespace {

/// The channel of each kind of measurement.
constexpr std::array<bus::Channel, pose::kNumMeasurementKinds> kChannelOfKind{
    bus::Channel::kOdometry, bus::Channel::kImu,  bus::Channel::kScan,
    bus::Channel::kPoseFix,  bus::Channel::kGnss, bus::Channel::kDetections};

constexpr std::size_t kNumKinds = pose::kNumMeasurementKinds;

timing::OrderedQueue<pose::Measurement, kNumKinds>::Rules rules_of(
    const pose::MeasurementWaits& waits_s) {
  timing::OrderedQueue<pose::Measurement, kNumKinds>::Rules rules;
  for (std::size_t kind = 0; kind < kNumKinds; ++kind) {
    if (waits_s[kind]) rules[kind].wait_us = std::llround(*waits_s[kind] * 1e6);
  }
  return rules;
}

pose::RigFacts rig_facts(const io::Config& config) {
  return {config.laser, config.laser_rear, config.detector.segmentation.blind_sector(),
          config.pose.scan_motion, config.pose.gnss};
}

/// The channels that tell whether the rig is as it is said to be.
constexpr bus::Channel kRigChannels[] = {bus::Channel::kScan, bus::Channel::kOdometry,
                                         bus::Channel::kPoseFix, bus::Channel::kGnss};

bool contains(const std::vector<bus::Channel>& channels, bus::Channel channel) {
  return std::find(channels.begin(), channels.end(), channel) != channels.end();
}

/// Converts a message to a measurement; none for other messages.
std::optional<pose::Measurement> measurement_of(const bus::Message& input) {
  return std::visit(
      [](const auto& m) -> std::optional<pose::Measurement> {
        constexpr bool kIsRear = std::is_same_v<std::decay_t<decltype(m)>, laser::RearScan>;
        if constexpr (std::is_constructible_v<pose::Measurement, decltype(m)> && !kIsRear) {
          return pose::Measurement(m);
        } else {
          return std::nullopt;
        }
      },
      input);
}

}  // namespace

PoseNode::PoseNode(const io::Config& config, std::shared_ptr<pose::ChunkAllocator> memory)
    : levelled_(config),
      waits_s_(pose::expected_measurements(config.pose)),
      queue_(rules_of(waits_s_)),
      localiser_(pose::make_localiser(
          config.pose,
          config.pose.mode == pose::PoseMode::kPriorMap ? io::read_prior_map(config.pose)
                                                        : pose::PriorMapData{},
          config.laser, config.detector.segmentation.blind_sector(), std::move(memory))),
      checks_rig_(config.pose.mode != pose::PoseMode::kStationary),
      moves_by_scans_(pose::reads_scans(config.pose)),
      rig_(rig_facts(config)),
      rig_monitor_(rig_) {}

std::vector<bus::Channel> PoseNode::mode_inputs() const {
  std::vector<bus::Channel> channels;
  for (std::size_t kind = 0; kind < waits_s_.size(); ++kind) {
    if (waits_s_[kind]) channels.push_back(kChannelOfKind[kind]);
  }
  return channels;
}

std::vector<bus::Channel> PoseNode::inputs() const {
  std::vector<bus::Channel> channels = mode_inputs();
  levelled_.add_channels(channels);
  if (!checks_rig_) return channels;
  for (const bus::Channel channel : kRigChannels) {
    if (!contains(channels, channel)) channels.push_back(channel);
  }
  if (rig_.laser_rear.enabled) channels.push_back(bus::Channel::kScanRear);
  return channels;
}

/// GNSS and IMU are optional; odometry, scans and trunks are required by the modes that use them.
/// What only checks the rig, and odometry where the scans tell the motion, may be absent.
bus::InputNeed PoseNode::need_of(bus::Channel channel) const {
  const std::vector<bus::Channel> of_mode = mode_inputs();
  if (!contains(of_mode, channel)) {
    return levelled_.reads(channel) ? bus::InputNeed::kOptional : bus::InputNeed::kOccasional;
  }
  if (channel == bus::Channel::kGnss || channel == bus::Channel::kImu) {
    return bus::InputNeed::kOptional;
  }
  if (moves_by_scans_) {
    if (channel == bus::Channel::kOdometry) return bus::InputNeed::kOccasional;
  } else if (channel == bus::Channel::kScan && contains(of_mode, bus::Channel::kOdometry)) {
    return bus::InputNeed::kOptional;  // only for loop closure
  }
  const bool only_fixes = channel == bus::Channel::kPoseFix && of_mode.size() == 1;
  return only_fixes ? bus::InputNeed::kRequired : Node::need_of(channel);
}

void PoseNode::handle(const bus::Message& input, const bus::Outbox& send) {
  levelled_.pass(input, [&](const bus::Message& message) { take(message, send); });
}

void PoseNode::take(const bus::Message& input, const bus::Outbox& send) {
  if (checks_rig_) check_rig(input);
  if (std::optional<pose::Measurement> measurement = measurement_of(input)) {
    if (waits_s_[measurement->index()]) push(*std::move(measurement));
  }
  while (auto measurement = queue_.pop()) use(*std::move(measurement), send);
}

void PoseNode::check_rig(const bus::Message& input) {
  if (const auto* rear = std::get_if<laser::RearScan>(&input)) {
    rig_monitor_.add_rear(*rear);
  } else if (const auto* scan = std::get_if<laser::Scan>(&input)) {
    rig_monitor_.add(*scan);
  } else if (const auto* odometry = std::get_if<pose::Odometry>(&input)) {
    rig_monitor_.add(*odometry);
  } else if (const auto* fix = std::get_if<pose::PoseFix>(&input)) {
    rig_monitor_.add(*fix);
  } else if (const auto* gnss = std::get_if<pose::Gnss>(&input)) {
    rig_monitor_.add(*gnss);
  }
}

std::vector<Finding> PoseNode::findings() const {
  std::vector<Finding> findings = rig_monitor_.findings();
  for (Finding& finding : localiser_->findings()) findings.push_back(std::move(finding));
  return findings;
}

void PoseNode::push(pose::Measurement measurement) {
  const std::size_t kind = measurement.index();
  const std::int64_t utime = pose::utime_of(measurement);
  // A measurement at the released time is late, too: its pose has been published.
  if (utime <= released_utime_ || utime < queue_.reached(kind)) {
    ++num_late_;
    return;
  }
  queue_.push(kind, utime, std::move(measurement));
}

void PoseNode::flush(const bus::Outbox& send) {
  levelled_.flush([&](const bus::Message& message) { take(message, send); });
  while (auto measurement = queue_.pop_flushed()) use(*std::move(measurement), send);
  localiser_->finish();
  if (checks_rig_) rig_monitor_.finish();
  // The last pose was sent before this correction, so it is corrected like those before it.
  send_correction(send, last_utime_ + 1);
}

void PoseNode::use(pose::Measurement measurement, const bus::Outbox& send) {
  released_utime_ = pose::utime_of(measurement);
  const std::int64_t steady_utime = steady_time_.next(measurement.index(), released_utime_);
  std::visit([steady_utime](auto& m) { m.utime = steady_utime; }, measurement);
  localiser_->add(measurement);
  // Send the correction first: poses from this time on include it.
  send_correction(send, Queue::kNever);
  for (pose::PoseEstimate& past : localiser_->take_past_poses()) send_pose(past, send);
  std::optional<pose::PoseEstimate> estimate = localiser_->estimate();
  // Measurements with the same time give one pose.
  if (estimate && queue_.next_utime() != steady_time_.drive_time(estimate->utime)) {
    send_pose(*estimate, send);
  }
}

void PoseNode::send_pose(pose::PoseEstimate& estimate, const bus::Outbox& send) {
  estimate.utime = steady_time_.drive_time(estimate.utime);
  if (estimate.utime <= last_utime_) return;
  last_utime_ = estimate.utime;
  estimate.seq = next_seq_++;
  send(estimate);
}

void PoseNode::send_correction(const bus::Outbox& send, std::int64_t utime_min) {
  std::optional<pose::Trajectory> trajectory = localiser_->take_correction();
  if (!trajectory) return;
  for (pose::PoseEstimate& pose : trajectory->poses) {
    pose.utime = steady_time_.drive_time(pose.utime);
  }
  trajectory->utime = std::max(steady_time_.drive_time(trajectory->utime), utime_min);
  for (pose::TrajectoryPage& page : pose::paginate(*trajectory)) {
    page.seq = next_page_seq_++;
    send(std::move(page));
  }
}

bus::NodeCounts PoseNode::counts() const {
  bus::NodeCounts counts;
  counts.num_late = num_late_;
  return counts;
}

std::string PoseNode::waiting_for() const {
  const std::optional<std::int64_t> utime = queue_.next_utime();
  const std::optional<std::size_t> missing = utime ? queue_.blocker(*utime) : std::nullopt;
  if (!missing) return {};
  return "the pose at " + std::to_string(timing::utime_of(*utime)) + " us waits for " +
         std::string(bus::info(kChannelOfKind[*missing]).name) + " of that time or later";
}

}  // namespace orchard::procs
