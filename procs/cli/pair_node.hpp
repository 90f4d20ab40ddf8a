// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>
#include <utility>
#include <vector>

#include "bus/node/node.hpp"
#include "detection/scan_image_pairer.hpp"

namespace orchard::cli {

/// A node that looks at the scan-image pairs of a log; sends nothing.
class PairNode : public bus::Node {
 public:
  /// `inputs`: SCAN, and what its pairs need of IMAGE and ODOMETRY.
  PairNode(std::vector<bus::Channel> inputs, detection::ScanImagePairer pairer)
      : inputs_(std::move(inputs)), pairer_(std::move(pairer)) {}

  std::string_view name() const override { return "pairs"; }
  std::vector<bus::Channel> inputs() const override { return inputs_; }
  void handle(const bus::Message& input, const bus::Outbox&) override {
    if (const auto* scan = std::get_if<laser::Scan>(&input)) {
      observe_all(pairer_.add(*scan));
    } else if (const auto* image = std::get_if<vision::Image>(&input)) {
      observe_all(pairer_.add(*image));
    } else if (const auto* odometry = std::get_if<pose::Odometry>(&input)) {
      observe_all(pairer_.add(
          detection::Motion{odometry->utime, odometry->speed_mps, odometry->yaw_rate_radps}));
    }
  }
  void flush(const bus::Outbox&) override { observe_all(pairer_.flush()); }

 protected:
  /// Called for each pair, in order of the scans.
  virtual void observe(detection::ScanImagePair pair) = 0;

 private:
  void observe_all(std::vector<detection::ScanImagePair> pairs) {
    for (auto& pair : pairs) observe(std::move(pair));
  }

  std::vector<bus::Channel> inputs_;
  detection::ScanImagePairer pairer_;
};

}  // namespace orchard::cli
