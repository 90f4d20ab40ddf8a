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
#include "bus/messages/message.hpp"
#include "bus/node/sequence_gate.hpp"

namespace orchard::bus {

/// Queue of received messages that wait for their node, bounded in number and size. The order is
/// that of arrival, between channels, too, also while a message waits for a predecessor that was
/// lost; messages of one channel that the network swapped are sorted by seq.
class Inbox {
 public:
  using Clock = std::chrono::steady_clock;

  /// How long a message waits for a missing predecessor; networks swap messages within less.
  static constexpr std::chrono::milliseconds kReorderWait{60};
  /// Limits on waiting messages per channel and on their total size [bytes]; messages beyond are
  /// dropped.
  static constexpr std::size_t kMessagesMax = 2000;
  static constexpr std::size_t kBytesMax = 64 << 20;
  /// How long an image may wait for a slow node that can do nothing without them, when newer ones
  /// arrive. A busy machine stops a process for tenths of a second; one that lags for longer is too
  /// slow for its images, and the newest matter.
  static constexpr std::chrono::milliseconds kImageWait{1000};

  struct Arrival {
    Clock::time_point time;  ///< of arrival, or of a predecessor's that arrived later
    Message message;
    std::size_t num_bytes = 0;  ///< encoded size as received
  };

  /// `needs_images`: false for a node that works without images and may use each of them late.
  explicit Inbox(bool needs_images = true) : needs_images_(needs_images) {}

  void add(Arrival arrival);

  /// Releases all messages that still wait for a missing predecessor.
  void release_all();

  /// Takes the next message for the node. None when the queue is empty or the next message still
  /// waits for its predecessor.
  std::optional<Arrival> take(Clock::time_point now);

  /// Time until take() returns a message [ms]; none when nothing waits.
  std::optional<int> ms_until_next(Clock::time_point now) const;

  std::size_t size() const { return ready_.size() + num_parked_; }
  std::int64_t num_dropped() const { return num_dropped_; }

 private:
  struct Lane {
    std::optional<std::int32_t> last_seq;  ///< highest seq passed on
    std::vector<Arrival> parked;           ///< waiting for a predecessor, in order of seq
    std::size_t num_ready = 0;
    Clock::time_point passed_time;  ///< of the last one passed on
  };
  Lane& lane_of(const Message& message) {
    return lanes_[static_cast<std::size_t>(channel_of(message))];
  }
  void pass(Lane& lane, Arrival arrival);
  void release(Lane& lane, Clock::time_point arrived_before);
  bool is_held() const;
  void drop_images_before(Clock::time_point time);
  void forget(Lane& lane, const Arrival& arrival);

  bool needs_images_;
  std::deque<Arrival> ready_;
  std::array<Lane, kNumChannels> lanes_;
  std::size_t num_parked_ = 0;
  std::size_t num_bytes_ = 0;
  std::int64_t num_dropped_ = 0;
};

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
    std::optional<Clock::time_point> stale_from;  ///< if nothing comes before
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
