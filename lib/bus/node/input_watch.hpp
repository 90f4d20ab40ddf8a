// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "bus/messages/channel.hpp"
#include "bus/node/sequence_gate.hpp"

namespace orchard::bus {

/// Monitors the input channels of a live process: detects channels that have fallen silent and
/// measures the fraction of lost messages. Times are times of arrival.
class InputWatch {
 public:
  using Clock = std::chrono::steady_clock;

  /// Records that a message of the channel has arrived.
  void note(Channel channel, Clock::time_point now);

  /// Updates which channels are silent. Returns whether that changed since the last call.
  bool update(Clock::time_point now);
  bool is_stale(Channel channel) const { return at(channel).stale; }

  /// Whether the channel needs attention: it is silent, or messages were lost or refused recently.
  bool is_serious(Channel channel) const;
  bool has_two_sources(Channel channel) const;

  /// Time until the result of update() can change [ms], at most 1000.
  int ms_until_change(Clock::time_point now) const;

  /// Adds the gate's current totals of a channel. Call it once a second.
  void count(Channel channel, const SequenceCounts& counts, std::int64_t num_used);

  /// Describes the problems of a channel for the user: "SCAN is silent for 2.3 s (came every 0.10
  /// s)", "SCAN: 4.8 % lost of the last 10 s". Empty when there are none.
  std::string text(Channel channel, Clock::time_point now) const;

 private:
  struct Totals {
    SequenceCounts counts;
    std::int64_t num_used = 0;
  };
  struct Input {
    std::optional<Clock::time_point> last;
    std::array<std::chrono::duration<double>, 16> gaps{};
    std::size_t num_gaps = 0;
    bool stale = false;
    std::deque<Totals> seconds;  ///< totals of the last ten seconds
  };
  const Input& at(Channel channel) const { return inputs_[static_cast<std::size_t>(channel)]; }
  static SequenceCounts recent_counts(const Input& input);
  static std::optional<std::chrono::duration<double>> period(const Input& input);
  static std::optional<Clock::time_point> stale_from(const Input& input);

  std::array<Input, kNumChannels> inputs_;
};

}  // namespace orchard::bus
