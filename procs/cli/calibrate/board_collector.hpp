// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "bus/node/node.hpp"
#include "calibration/extrinsics/stationary_views.hpp"
#include "detection/scan_image_pairer.hpp"
#include "io/config/config.hpp"

namespace orchard::cli {

/// A node that detects a calibration board in a log's scan-image pairs; sends nothing.
class BoardCollector : public bus::Node {
 public:
  BoardCollector(const io::Config& config, const calibration::BoardConfig& board);

  std::string_view name() const override { return "calibration"; }
  std::vector<bus::Channel> inputs() const override;
  void handle(const bus::Message& input, const bus::Outbox& send) override;
  void flush(const bus::Outbox& send) override;

  /// The pairs with the board in their picture, in order of time.
  const std::vector<calibration::BoardPair>& pairs() const { return pairs_; }
  int num_scans() const { return num_scans_; }
  int num_images() const { return num_images_; }
  int num_pairs() const { return num_pairs_; }
  /// Number of unreadable pictures in pairs.
  int num_unreadable() const { return num_unreadable_; }
  /// Number of pictures with another size than configured.
  int num_wrong_size() const { return num_wrong_size_; }
  /// Size of the last of them, "640x480"; empty: none.
  const std::string& wrong_size() const { return wrong_size_; }

 private:
  void observe(const detection::ScanImagePair& pair);

  geometry::CameraIntrinsics intrinsics_;
  calibration::BoardConfig board_;
  detection::ScanImagePairer pairer_;
  std::vector<calibration::BoardPair> pairs_;
  int num_scans_ = 0;
  int num_images_ = 0;
  int num_pairs_ = 0;
  int num_unreadable_ = 0;
  int num_wrong_size_ = 0;
  std::string wrong_size_;
};

}  // namespace orchard::cli
