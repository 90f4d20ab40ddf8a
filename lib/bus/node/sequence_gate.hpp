// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "bus/messages/channel.hpp"

namespace orchard::bus {

/// What the sequence numbers of arriving messages said.
struct SequenceCounts {
  std::int64_t num_lost = 0;       ///< missing by seq
  std::int64_t num_duplicate = 0;  ///< same or older seq, not later in time
  std::int64_t num_backward = 0;   ///< newer seq, earlier utime: a clock was set back
  std::int64_t num_restarts = 0;   ///< a source that began again
};

/// Decides per channel whether a message is new. The same rule holds live, in the order of
/// arrival, and for a log, in the order of the file: so both use the same messages.
///
/// New is a higher seq that is not earlier in time. A seq that falls while time goes on is a source
/// that was started again. Time that goes back is refused, until ten messages in a row agree that
/// the source's clock was set back.
class SequenceGate {
 public:
  bool accept(Channel channel, std::int32_t seq, std::int64_t utime);
  const SequenceCounts& counts() const { return counts_; }

 private:
  struct Last {
    bool seen = false;
    std::int32_t seq = 0;
    std::int64_t utime = 0;
    int num_backward = 0;  ///< refused in a row
    std::int64_t backward_utime = 0;
  };
  std::array<Last, kNumChannels> last_;
  SequenceCounts counts_;
};

}  // namespace orchard::bus
