// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "simulation/device/emulated_device.hpp"

namespace orchard::simulation {

/// A robot's controller that prints odometry as V lines and an inertial unit's samples as I lines,
/// with the time of its own clock (32 bits of microseconds) and checksums (lib/device/lines).
class ControllerDevice : public EmulatedDevice {
 public:
  explicit ControllerDevice(const EmulatedClock& clock) : clock_(clock) {}

  /// An empty line first, as controllers print at their start: who listens skips what comes before.
  void connected(std::int64_t) override { to_send_ = "\r\n"; }
  void receive(std::string_view, std::int64_t) override {}
  void measured(const device::Measurement& measurement) override;
  std::optional<std::int64_t> deadline() const override { return std::nullopt; }
  void advance(std::int64_t) override {}

 private:
  EmulatedClock clock_;
};

}  // namespace orchard::simulation
