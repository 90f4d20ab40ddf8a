// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace orchard::bus {

/// The clock that stamps measurements: the host's time of day (CLOCK_REALTIME), which every process
/// of a host and, kept by NTP or PTP, every host of a robot shares. Slewing shows in it as a rate
/// of at most 500 ppm; a step is noticed against CLOCK_MONOTONIC, which slews alike and never
/// steps.
class HostClock {
 public:
  HostClock();

  /// Now [us since 1970].
  std::int64_t now();

  /// By how much the clock was set between calls of now(), since the last call of this [us].
  std::int64_t take_step();

 private:
  std::int64_t offset_us_;  ///< time of day over monotonic time
  std::int64_t step_us_ = 0;
};

}  // namespace orchard::bus
