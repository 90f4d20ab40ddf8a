// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bus/node/levelled_inputs.hpp"
#include "bus/node/node.hpp"
#include "io/config/config.hpp"
#include "pose/graph/record_store.hpp"
#include "pose/localiser.hpp"
#include "pose/measurements.hpp"
#include "pose/rig/rig_monitor.hpp"
#include "timing/drive_time.hpp"
#include "timing/ordered_queue.hpp"

namespace orchard::procs {

/// Estimates the robot's pose: one POSE per time of measurement, in order of time, and TRAJECTORY
/// whenever the past is corrected. The localiser has steady time: a clock that is set back moves no
/// robot.
class PoseNode : public bus::Node {
 public:
  /// Throws io::FileError when the map of mode prior_map cannot be read. `memory` stores the data
  /// of a long drive; none: the heap. It changes no output.
  explicit PoseNode(const io::Config& config,
                    std::shared_ptr<pose::ChunkAllocator> memory = nullptr);

  std::string_view name() const override { return "pose"; }
  std::vector<bus::Channel> inputs() const override;
  bus::InputNeed need_of(bus::Channel channel) const override;
  void handle(const bus::Message& input, const bus::Outbox& send) override;
  void flush(const bus::Outbox& send) override;
  bus::NodeCounts counts() const override;
  std::string waiting_for() const override;
  std::string warning() const override { return localiser_->warning(); }
  /// Of the rig, which may be the cause of what is wrong with the path; then of the path.
  std::vector<Finding> findings() const override;
  /// What the drive tells about the rig.
  const pose::RigEstimates& rig_estimates() const { return rig_monitor_.estimates(); }
  /// Statistics of the localiser as named numbers.
  std::vector<std::pair<std::string, std::int64_t>> statistics() const {
    return localiser_->statistics();
  }

 private:
  /// The channels that pose.mode uses; the others only check the rig.
  std::vector<bus::Channel> mode_inputs() const;
  void take(const bus::Message& input, const bus::Outbox& send);
  void check_rig(const bus::Message& input);
  void push(pose::Measurement measurement);
  void use(pose::Measurement measurement, const bus::Outbox& send);
  /// Sends the pose of a steady time, unless one of that time or a later one was sent.
  void send_pose(pose::PoseEstimate& estimate, const bus::Outbox& send);
  /// Sends the newest trajectory, if any; it corrects all poses before its utime or `utime_min`.
  void send_correction(const bus::Outbox& send, std::int64_t utime_min);

  using Queue = timing::OrderedQueue<pose::Measurement, pose::kNumMeasurementKinds>;

  bus::LevelledInputs levelled_;
  pose::MeasurementWaits waits_s_;
  Queue queue_;
  std::int64_t released_utime_ = Queue::kNever;  ///< of the last measurement used
  std::int64_t num_late_ = 0;
  timing::SteadyTime<pose::kNumMeasurementKinds> steady_time_;
  std::unique_ptr<pose::Localiser> localiser_;
  bool checks_rig_;
  bool moves_by_scans_;
  pose::RigFacts rig_;
  pose::RigMonitor rig_monitor_;
  std::int64_t last_utime_ = std::numeric_limits<std::int64_t>::min();  ///< of the last POSE
  std::int32_t next_seq_ = 0;
  std::int32_t next_page_seq_ = 0;
};

}  // namespace orchard::procs
