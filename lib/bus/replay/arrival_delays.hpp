// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "bus/messages/channel.hpp"

namespace orchard::bus {

/// How long after its measurement a log recorded each message of the sensors that tell at once: by
/// that a clock that differs from the others' is seen, as STATUS shows it live.
class ArrivalDelays {
 public:
  void add(Channel channel, std::int64_t utime, std::int64_t recorded_utime);

  /// A sentence for people on the channels whose clock is another; none where all agree, where only
  /// one tells, and where the log was not recorded as it was measured.
  std::vector<std::string> warnings() const;

 private:
  /// Every so many messages one is kept, so that a long log needs no more than a short one.
  struct Sample {
    std::int64_t num = 0;
    std::int64_t every = 1;
    std::vector<std::int64_t> delays_us;
  };
  std::array<Sample, kNumChannels> samples_;
};

}  // namespace orchard::bus
