// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibration/extrinsics/camera_delay.hpp"
#include "cli/pair_node.hpp"
#include "detection/rig.hpp"
#include "io/config/config.hpp"

namespace orchard::cli {

/// Collects observations of trunks in a log's pairs for the calibration of the camera's delay.
class DelayCollector : public PairNode {
 public:
  /// `first_picture`: number of the first picture. Throws nothing.
  DelayCollector(const io::Config& config, std::int32_t first_picture);

  const std::vector<calibration::DelayObservation>& observations() const { return observations_; }
  std::int32_t next_picture() const { return next_picture_; }
  int num_pairs() const { return num_pairs_; }
  int num_moving() const { return num_moving_; }  ///< number of pairs with ODOMETRY at their time

 private:
  void observe(detection::ScanImagePair pair) override;

  detection::Rig rig_;
  double reach_px_;
  std::int32_t next_picture_;
  int num_pairs_ = 0;
  int num_moving_ = 0;
  std::vector<calibration::DelayObservation> observations_;
};

}  // namespace orchard::cli
