// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "device/emulated/emulated_device.hpp"

namespace orchard::device {

/// An emulated controller of a robot: sends odometry as V lines and IMU samples as I lines, with
/// its own clock (32 bits of microseconds) and checksums (lib/device/lines).
class ControllerDevice : public EmulatedDevice {
 public:
  explicit ControllerDevice(const EmulatedClock& clock) : clock_(clock) {}

  /// Sends an empty line first, as controllers do at their start: the receiver skips everything
  /// before it.
  void connected(std::int64_t) override { to_send_ = "\r\n"; }
  void receive(std::string_view, std::int64_t) override {}
  void measured(const device::Measurement& measurement) override;
  std::optional<std::int64_t> deadline() const override { return std::nullopt; }
  void advance(std::int64_t) override {}

 private:
  EmulatedClock clock_;
};

}  // namespace orchard::device
