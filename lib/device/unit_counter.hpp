// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>

namespace orchard::device {

/// Numbers of units received from the device since the start, over all connections.
struct ProtocolCounts {
  std::int64_t num_good = 0;  ///< complete and valid units: a sweep, a line, a report
  std::int64_t num_bad = 0;   ///< rejected units: checksum, length, number, range
};

/// Counts a device's units, and tells when many of the last ten seconds were refused.
class UnitCounter {
 public:
  void add_good(std::int64_t host_utime);

  /// `why`: as text for the user.
  void add_refused(std::int64_t host_utime, std::string why);

  /// The host's clock was set: forgets the last seconds.
  void host_clock_stepped() { seconds_.clear(); }

  const ProtocolCounts& counts() const { return counts_; }

  /// "7 of 20 sweeps refused in 10 s: a wrong checksum" where more than one and more than 2 % of
  /// the ten seconds up to the last unit were; empty otherwise.
  std::string warning(std::string_view units) const;

 private:
  struct Second {
    std::int64_t number = 0;
    ProtocolCounts counts;
  };
  ProtocolCounts& at(std::int64_t host_utime);

  ProtocolCounts counts_;
  std::deque<Second> seconds_;
  std::string why_;  ///< the last refusal
};

}  // namespace orchard::device
