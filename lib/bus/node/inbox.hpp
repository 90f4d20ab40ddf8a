// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "bus/messages/message.hpp"

namespace orchard::bus {

/// Queue of received messages that wait for their node, bounded in number and size. The order is
/// that of arrival; messages of one channel that the network swapped are sorted by seq.
class Inbox {
 public:
  using Clock = std::chrono::steady_clock;

  /// How long a message waits for a missing predecessor; networks swap messages within less.
  static constexpr std::chrono::milliseconds kReorderWait{60};
  /// Limits on waiting messages per channel and on their total size [bytes]; messages beyond are
  /// dropped.
  static constexpr std::size_t kMessagesMax = 2000;
  static constexpr std::size_t kBytesMax = 64 << 20;
  /// Max number of images waiting for a slow node; beyond it the oldest is dropped, because the
  /// newest matter.
  static constexpr std::size_t kImagesMax = 4;

  struct Arrival {
    Clock::time_point time;
    Message message;
    std::size_t num_bytes = 0;  ///< encoded size as received
  };

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
  };
  Lane& lane_of(const Message& message) {
    return lanes_[static_cast<std::size_t>(channel_of(message))];
  }
  void pass(Lane& lane, Arrival arrival);
  void release(Lane& lane, Clock::time_point arrived_before);
  void drop_oldest_image();
  void forget(Lane& lane, const Arrival& arrival);

  std::deque<Arrival> ready_;
  std::array<Lane, kNumChannels> lanes_;
  std::size_t num_parked_ = 0;
  std::size_t num_bytes_ = 0;
  std::int64_t num_dropped_ = 0;
};

}  // namespace orchard::bus
