// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <vector>

#include "bus/node/node.hpp"
#include "calibration/extrinsics/camera_delay.hpp"
#include "detection/scan_image_pairer.hpp"
#include "io/config/config.hpp"

namespace orchard::cli {

/// A node that collects observations of trunks in a log's scan-image pairs for the calibration of
/// the camera's delay; sends nothing.
class DelayCollector : public bus::Node {
 public:
  /// `first_picture`: number of the first picture. Throws nothing.
  DelayCollector(const io::Config& config, std::int32_t first_picture);

  std::string_view name() const override { return "calibration"; }
  std::vector<bus::Channel> inputs() const override {
    return {bus::Channel::kScan, bus::Channel::kImage, bus::Channel::kOdometry};
  }
  void handle(const bus::Message& input, const bus::Outbox& send) override;
  void flush(const bus::Outbox& send) override;

  const std::vector<calibration::DelayObservation>& observations() const { return observations_; }
  std::int32_t next_picture() const { return next_picture_; }
  int num_pairs() const { return num_pairs_; }
  int num_moving() const { return num_moving_; }  ///< number of pairs with ODOMETRY at their time

 private:
  void observe(const detection::ScanImagePair& pair);

  detection::Rig rig_;
  detection::ScanImagePairer pairer_;
  double reach_px_;
  std::int32_t next_picture_;
  int num_pairs_ = 0;
  int num_moving_ = 0;
  std::vector<calibration::DelayObservation> observations_;
};

}  // namespace orchard::cli
