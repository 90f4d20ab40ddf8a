// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <memory>

#include "bus/node/node.hpp"
#include "io/config/config.hpp"
#include "pose/localiser.hpp"
#include "pose/measurement_queue.hpp"

namespace orchard::procs {

/// Says where the robot is: one POSE per time of measurement, in order of time, and TRAJECTORY
/// whenever the past was corrected.
class PoseNode : public bus::Node {
 public:
  /// Throws io::FileError when mode prior_map has no map to go by.
  explicit PoseNode(const io::Config& config);

  std::string_view name() const override { return "pose"; }
  std::vector<bus::Channel> inputs() const override;
  void handle(const bus::Message& input, const bus::Outbox& send) override;
  void flush(const bus::Outbox& send) override;
  bus::NodeCounts counts() const override;
  std::string waiting_for() const override;
  std::string warning() const override { return localiser_->warning(); }

 private:
  void take(const pose::Measurement& measurement, const bus::Outbox& send);
  void send_correction(const bus::Outbox& send);

  pose::MeasurementWaits waits_s_;
  pose::MeasurementQueue queue_;
  std::unique_ptr<pose::Localiser> localiser_;
  std::int64_t last_utime_ = std::numeric_limits<std::int64_t>::min();  ///< of the last POSE
  std::int32_t next_seq_ = 0;
  std::int32_t next_page_seq_ = 0;
};

}  // namespace orchard::procs
