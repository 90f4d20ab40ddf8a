// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "bus/node/sequence_gate.hpp"

namespace orchard::bus {

/// Messages behind the gate, live or of a log: keeps those that it holds, and gives the others
/// their drive times.
template <class Item>
class Gated {
 public:
  struct Used {
    std::int64_t drive_time = 0;
    Item item;
  };

  /// What is used now: of this message, of those held before it, and of those of other channels
  /// that it confirms; in order of time, as they would have come if none had been held.
  std::vector<Used> add(Channel channel, std::int32_t seq, std::int64_t utime,
                        std::optional<std::int64_t> arrival_us, Item item) {
    std::vector<Used> used;
    std::vector<Used>& held = held_of(channel);
    const GateDecision decision = gate_.accept(channel, seq, utime, arrival_us);
    was_reordered_ = decision == GateDecision::kReordered;
    if (was_reordered_) {
      used.push_back({gate_.drive_time_of_reordered(channel, utime), std::move(item)});
    }
    if (was_reordered_ || decision == GateDecision::kDuplicate) return used;
    held.push_back({utime, std::move(item)});
    const auto num_kept =
        static_cast<std::size_t>(decision == GateDecision::kHeld ? gate_.num_held(channel) : 1);
    if (decision != GateDecision::kConfirmed) held.erase(held.begin(), held.end() - num_kept);
    if (decision == GateDecision::kHeld) return used;
    take_held(channel, used);
    for (const ChannelInfo& other : kChannels) {
      if (gate_.confirm_held(other.channel)) take_held(other.channel, used);
    }
    std::stable_sort(used.begin(), used.end(),
                     [](const Used& a, const Used& b) { return a.drive_time < b.drive_time; });
    return used;
  }
  /// Whether the last message of add() came after a later one of its channel.
  bool was_reordered() const { return was_reordered_; }

  SequenceGate& gate() { return gate_; }
  const SequenceGate& gate() const { return gate_; }

 private:
  std::vector<Used>& held_of(Channel channel) { return held_[static_cast<std::size_t>(channel)]; }

  void take_held(Channel channel, std::vector<Used>& used) {
    for (Used& early : std::exchange(held_of(channel), {})) {
      const auto drive_time = gate_.drive_time(channel, early.drive_time);
      if (drive_time) used.push_back({*drive_time, std::move(early.item)});
    }
  }

  SequenceGate gate_;
  std::array<std::vector<Used>, kNumChannels> held_;  ///< with their utime
  bool was_reordered_ = false;
};

}  // namespace orchard::bus
