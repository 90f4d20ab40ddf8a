// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <poll.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "bus/driver/device_server.hpp"
#include "bus/driver/stream_driver.hpp"
#include "device/emulated/emulated_device.hpp"
#include "device/protocol.hpp"

namespace orchard {

/// A driver and the emulated scanner that it reads, in one loop in real time. The scanner measures
/// at 40 Hz; sweep i has the range 1 m + i mm, so that each one that comes out is known.
class DrivenLaser {
 public:
  using Clock = bus::Driver::Clock;
  static constexpr std::int64_t kPeriod_us = 25'000;

  DrivenLaser(std::unique_ptr<device::Protocol> protocol,
              std::unique_ptr<device::EmulatedDevice> device, const std::string& where,
              laser::Scan geometry, const std::string& raw_path = {})
      : server_(std::move(device), where),
        driver_(std::move(protocol), bus::parse_port(server_.address()), raw_path),
        geometry_(std::move(geometry)),
        begin_utime_(server_.now()) {}

  bus::DeviceServer& server() { return server_; }
  bus::StreamDriver& driver() { return driver_; }
  const std::vector<laser::Scan>& scans() const { return scans_; }

  /// When the sweep that a scan is of truly began [us].
  std::int64_t true_utime(const laser::Scan& scan) const {
    const double mm = 1e3 * static_cast<double>(scan.ranges_m.front()) - 1000.0;
    return begin_utime_ + kPeriod_us * std::lround(mm);
  }

  /// Lets both work until `done` or for at most a minute; false when the time was up.
  template <class Done>
  bool run_until(Done done) {
    const Clock::time_point end = Clock::now() + std::chrono::seconds(60);
    while (!done()) {
      if (Clock::now() > end) return false;
      turn();
    }
    return true;
  }

  /// The host stands still for so long: what the scanner sends meanwhile waits.
  void hold_up(std::chrono::milliseconds time) {
    const Clock::time_point end = Clock::now() + time;
    while (Clock::now() < end) turn(false);
  }

  void turn(bool with_driver = true) {
    std::vector<pollfd> files;
    if (with_driver) files = driver_.files();
    for (const pollfd& file : server_.files()) files.push_back(file);
    const auto begin = std::chrono::microseconds(begin_utime_ + next_ * kPeriod_us - server_.now());
    Clock::time_point due = std::min(server_.deadline(), Clock::now() + begin);
    if (with_driver) due = std::min(due, driver_.deadline());
    const auto wait = std::chrono::ceil<std::chrono::milliseconds>(due - Clock::now()).count();
    poll(files.data(), files.size(), static_cast<int>(std::clamp<std::int64_t>(wait, 0, 100)));
    while (begin_utime_ + next_ * kPeriod_us <= server_.now()) {
      laser::Scan scan = geometry_;
      scan.utime = begin_utime_ + next_ * kPeriod_us;
      for (float& range_m : scan.ranges_m) {
        range_m = static_cast<float>(1e-3 * static_cast<double>(1000 + next_));
      }
      server_.measured(scan);
      ++next_;
    }
    server_.step();
    if (!with_driver) return;
    driver_.step([this](bus::Message message) {
      if (auto* scan = std::get_if<laser::Scan>(&message)) scans_.push_back(std::move(*scan));
    });
  }

 private:
  bus::DeviceServer server_;
  bus::StreamDriver driver_;
  laser::Scan geometry_;
  std::int64_t begin_utime_;
  std::int64_t next_ = 0;
  std::vector<laser::Scan> scans_;
};

/// 270 degrees in quarters of a degree, 40 turns a second, no intensities.
inline laser::Scan field_scanner() {
  laser::Scan scan;
  scan.bearing_step_rad = 2.0 * 3.14159265358979323846 / 1440;
  scan.bearing_min_rad = -540 * scan.bearing_step_rad;
  scan.beam_period_us = 25e3 / 1440;
  scan.range_min_m = 0.02;
  scan.range_max_m = 30.0;
  scan.ranges_m.resize(1081);
  return scan;
}

}  // namespace orchard
