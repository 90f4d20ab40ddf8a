// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace orchard::bus {

/// Clock that stamps measurements: the host's time of day (CLOCK_REALTIME), shared by all processes
/// of a host and, when synchronized by NTP or PTP, by all hosts of a robot. Slewing changes its
/// rate by at most 500 ppm. A step is detected by comparison with CLOCK_MONOTONIC, which slews in
/// the same way but never steps.
class HostClock {
 public:
  HostClock();

  /// Now [us since 1970].
  std::int64_t now();

  /// Returns by how much now() has seen the clock set since the last call of take_step() [us].
  std::int64_t take_step();

 private:
  std::int64_t offset_us_;  ///< time of day minus monotonic time
  std::int64_t step_us_ = 0;
};

}  // namespace orchard::bus
