// SPDX-License-Identifier: BSD-3-Clause
#include "bus/node/sequence_gate.hpp"

namespace orchard::bus {
namespace {
constexpr int kNumBackwardToBelieve = 10;
}

bool SequenceGate::accept(Channel channel, std::int32_t seq, std::int64_t utime) {
  Last& last = last_[static_cast<std::size_t>(channel)];
  if (!last.seen) {
    last = {true, seq, utime, 0, 0};
    return true;
  }
  if (seq > last.seq && utime >= last.utime) {
    counts_.num_lost += seq - last.seq - 1;
    last = {true, seq, utime, 0, 0};
    return true;
  }
  if (seq <= last.seq && utime > last.utime) {
    ++counts_.num_restarts;
    last = {true, seq, utime, 0, 0};
    return true;
  }
  if (seq <= last.seq) {
    ++counts_.num_duplicate;
    return false;
  }
  ++counts_.num_backward;
  last.num_backward = utime >= last.backward_utime ? last.num_backward + 1 : 1;
  last.backward_utime = utime;
  if (last.num_backward < kNumBackwardToBelieve) return false;
  ++counts_.num_restarts;
  last = {true, seq, utime, 0, 0};
  return true;
}

}  // namespace orchard::bus
