// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "bus/messages/channel.hpp"

namespace orchard::bus {

/// Measures the delay between measurement and recording for sensors that publish without delay.
/// Differences between channels reveal a clock offset, which STATUS reports in a live system.
class ArrivalDelays {
 public:
  void add(Channel channel, std::int64_t utime, std::int64_t recorded_utime);

  /// Warnings for the user about channels with a different clock. Empty when all agree, when only
  /// one channel has data, or when the log was not recorded in real time.
  std::vector<std::string> warnings() const;

 private:
  /// Keeps every n-th message, so that memory does not grow with the log.
  struct Sample {
    std::int64_t num = 0;
    std::int64_t every = 1;
    std::vector<std::int64_t> delays_us;
  };
  std::array<Sample, kNumChannels> samples_;
};

}  // namespace orchard::bus
