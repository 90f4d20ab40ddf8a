// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "bus/node/node.hpp"
#include "calibration/trunks/trunk_observation.hpp"
#include "detection/scan_image_pairer.hpp"
#include "io/config/config.hpp"

namespace orchard::cli {

/// A node that collects all objects of a log's scan-image pairs for calibration; sends nothing.
class TrunkCollector : public bus::Node {
 public:
  TrunkCollector(const io::Config& config, int log, bool crops = false);

  std::string_view name() const override { return "calibration"; }
  std::vector<bus::Channel> inputs() const override;
  void handle(const bus::Message& input, const bus::Outbox& send) override;
  void flush(const bus::Outbox& send) override;

  /// All observations in order of time; in the map frame where poses around their time are known.
  std::vector<calibration::TrunkObservation> observations() const;
  /// All poses of the log, in order of time.
  const std::vector<pose::PoseEstimate>& poses() const { return poses_; }
  int num_pairs() const { return num_pairs_; }

 private:
  void observe(const detection::ScanImagePair& pair);

  detection::Rig rig_;
  detection::ScanImagePairer pairer_;
  std::int64_t pose_gap_max_us_;
  int log_;
  bool crops_;
  int num_pairs_ = 0;
  std::vector<calibration::TrunkObservation> in_base_;
  std::vector<pose::PoseEstimate> poses_;  ///< in order of utime
};

}  // namespace orchard::cli
