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

/// How the input channels of a live process fare: which came and has fallen silent, and what
/// fraction of each was lost lately. The clock is that of arrival.
class InputWatch {
 public:
  using Clock = std::chrono::steady_clock;

  /// A message of the channel has arrived.
  void note(Channel channel, Clock::time_point now);

  /// Compares with the last call who has fallen silent and who is back. Whether that has changed.
  bool update(Clock::time_point now);
  bool is_stale(Channel channel) const { return at(channel).stale; }

  /// Whether people should look: it is silent, or messages were lost or refused lately.
  bool is_serious(Channel channel) const;
  bool has_two_sources(Channel channel) const;

  /// When update() could next say something new [ms]; at most a second.
  int ms_until_change(Clock::time_point now) const;

  /// What the gate has counted so far on a channel: call it once a second.
  void count(Channel channel, const SequenceCounts& counts, std::int64_t num_used);

  /// "SCAN is silent for 2.3 s (came every 0.10 s)", "SCAN: 4.8 % lost of the last 10 s"; empty
  /// when all is well.
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
    std::deque<Totals> seconds;  ///< of the last ten
  };
  const Input& at(Channel channel) const { return inputs_[static_cast<std::size_t>(channel)]; }
  static SequenceCounts lately(const Input& input);
  static std::optional<std::chrono::duration<double>> period(const Input& input);
  static std::optional<Clock::time_point> stale_from(const Input& input);

  std::array<Input, kNumChannels> inputs_;
};

}  // namespace orchard::bus
