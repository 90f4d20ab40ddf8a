// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "bus/node/node.hpp"
#include "detection/detect.hpp"
#include "detection/scan_image_pairer.hpp"
#include "io/config/config.hpp"
#include "vision/appearance_config.hpp"

namespace orchard {

/// Appearance features of a window, with its scan and detection.
struct SeenWindow {
  std::int64_t utime = 0;  ///< of the scan
  std::size_t index = 0;   ///< of the detection in its message
  vision::AppearanceFeatures features{};
};

/// A node that collects the windows of all trunk candidates of the laser in every `stride`-th scan;
/// sends nothing.
class AppearanceCollector : public bus::Node {
 public:
  AppearanceCollector(const io::Config& config, int stride);

  std::string_view name() const override { return "calibration"; }
  std::vector<bus::Channel> inputs() const override;
  void handle(const bus::Message& input, const bus::Outbox& send) override;
  void flush(const bus::Outbox& send) override;

  const std::vector<detection::Detections>& messages() const { return messages_; }
  const std::vector<SeenWindow>& windows() const { return windows_; }

 private:
  void observe(const detection::ScanImagePair& pair);

  detection::Rig rig_;
  detection::ScanImagePairer pairer_;
  int stride_;
  int num_pairs_ = 0;
  std::vector<detection::Detections> messages_;
  std::vector<SeenWindow> windows_;
};

}  // namespace orchard
