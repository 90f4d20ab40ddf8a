// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "bus/node.hpp"
#include "io/config.hpp"
#include "pose/measurement_queue.hpp"
#include "pose/pose_estimator.hpp"

namespace orchard::procs {

/// Says where the robot is: one POSE per time of measurement, in order of time.
class PoseNode : public bus::Node {
 public:
  explicit PoseNode(const io::Config& config);

  std::string_view name() const override { return "pose"; }
  std::vector<bus::Channel> inputs() const override;
  void handle(const bus::Message& input, const bus::Outbox& send) override;
  void flush(const bus::Outbox& send) override;
  bus::NodeCounts counts() const override;
  std::string waiting_for() const override;

 private:
  void take(const pose::Measurement& measurement, const bus::Outbox& send);
  void send_pose(pose::PoseEstimate estimate, const bus::Outbox& send);

  pose::PoseMode mode_;
  pose::MeasurementQueue queue_;
  pose::PoseEstimator estimator_;
  std::int32_t next_seq_ = 0;
};

}  // namespace orchard::procs
