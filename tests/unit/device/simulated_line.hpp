// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "device/emulated/emulated_device.hpp"
#include "device/protocol.hpp"

namespace orchard::device {

/// A protocol and an emulated device with a line between them, in simulated time: bytes arrive late
/// by at least `way_us`, by an exponential time more, and sometimes a host is held up.
class SimulatedLine {
 public:
  SimulatedLine(Protocol& protocol, device::EmulatedDevice& device, std::int64_t utime,
                unsigned seed)
      : protocol_(protocol), device_(device), utime_(utime), random_(seed) {}

  double way_us = 200.0;
  double jitter_us = 0.0;            ///< mean of what is added
  double held_up_probability = 0.0;  ///< that it is 40 ms more
  /// May change what the device sends.
  std::function<void(std::string&)> spoil;

  std::int64_t utime() const { return utime_; }

  void connect() {
    on_line_.clear();
    device_.connected(utime_);
    protocol_.connected(utime_);
    exchange();
  }

  /// Lets time pass until `utime`.
  void run_until(std::int64_t utime) {
    while (true) {
      std::int64_t next = utime;
      if (!on_line_.empty()) next = std::min(next, on_line_.begin()->first);
      if (const auto due = device_.deadline()) next = std::min(next, *due);
      if (const auto due = protocol_.deadline()) next = std::min(next, *due);
      utime_ = std::max(utime_, next);
      while (!on_line_.empty() && on_line_.begin()->first <= utime_) {
        const auto [to_device, bytes] = on_line_.begin()->second;
        on_line_.erase(on_line_.begin());
        if (to_device) {
          device_.receive(bytes, utime_);
        } else {
          protocol_.receive(bytes, utime_);
        }
      }
      device_.advance(utime_);
      if (const auto due = protocol_.deadline(); due && *due <= utime_) protocol_.expire(utime_);
      exchange();
      if (utime_ >= utime) return;
    }
  }

 private:
  void exchange() {
    std::string sent = device_.take_to_send();
    if (!sent.empty()) {
      if (spoil) spoil(sent);
      put(false, sent);
    }
    sent = protocol_.take_to_send();
    if (!sent.empty()) put(true, sent);
  }

  void put(bool to_device, const std::string& bytes) {
    double late_us = way_us;
    if (!to_device && jitter_us > 0.0) {
      late_us += std::exponential_distribution<double>(1.0 / jitter_us)(random_);
      if (std::bernoulli_distribution(held_up_probability)(random_)) late_us += 40e3;
    }
    // In order, as a stream is.
    std::int64_t& last = last_[to_device ? 0 : 1];
    last = std::max(last, utime_ + static_cast<std::int64_t>(late_us));
    on_line_.emplace(last, std::pair(to_device, bytes));
  }

  Protocol& protocol_;
  device::EmulatedDevice& device_;
  std::int64_t utime_;
  std::mt19937 random_;
  std::multimap<std::int64_t, std::pair<bool, std::string>> on_line_;
  std::int64_t last_[2] = {0, 0};
};

}  // namespace orchard::device
