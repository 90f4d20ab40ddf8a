// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
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

/// An emulated gpsd with one receiver: sends fixes as GST and TPV reports (gpsd_json(5)),
/// `latency_s` after their time, to a client that has sent ?WATCH. Satellite time is true time.
class GpsdDevice : public EmulatedDevice {
 public:
  explicit GpsdDevice(double latency_s) : latency_us_(static_cast<std::int64_t>(1e6 * latency_s)) {}

  void connected(std::int64_t utime) override;
  void receive(std::string_view bytes, std::int64_t utime) override;
  void measured(const device::Measurement& measurement) override;
  std::optional<std::int64_t> deadline() const override;
  void advance(std::int64_t utime) override;

 private:
  std::int64_t latency_us_;
  std::string asked_;
  bool is_watched_ = false;
  std::deque<pose::Gnss> on_their_way_;
};

}  // namespace orchard::device
