// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "pose/localiser.hpp"

namespace orchard::pose {

/// The robot stands at the map's origin; its scans say when it was there.
class Stationary : public Localiser {
 public:
  void add(const Measurement& measurement) override {
    PoseEstimate origin;
    origin.utime = utime_of(measurement);
    estimate_ = origin;
  }
  std::optional<PoseEstimate> estimate() const override { return estimate_; }

 private:
  std::optional<PoseEstimate> estimate_;
};

}  // namespace orchard::pose
