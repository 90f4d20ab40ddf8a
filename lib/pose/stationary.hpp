// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "pose/localiser.hpp"

namespace orchard::pose {

/// Localiser of a robot that stands at the map's origin: every measurement gives the origin at its
/// utime.
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
