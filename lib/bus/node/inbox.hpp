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

/// Messages that have arrived and wait for their node: in order of arrival, but in order of seq
/// where a network has swapped those of one channel. Bounded, whatever arrives.
class Inbox {
 public:
  using Clock = std::chrono::steady_clock;

  /// How long a message waits for one before it that is missing: networks swap within less.
  static constexpr std::chrono::milliseconds kReorderWait{60};
  /// Messages of a channel, and bytes of all, that wait at most: what is more is dropped.
  static constexpr std::size_t kMessagesMax = 2000;
  static constexpr std::size_t kBytesMax = 64 << 20;
  /// Pictures that wait for a slow node; of more the oldest is dropped, since the newest matter.
  static constexpr std::size_t kImagesMax = 4;

  struct Arrival {
    Clock::time_point time;
    Message message;
    std::size_t num_bytes = 0;  ///< as it came
  };

  void add(Arrival arrival);

  /// Nothing is waited for any longer.
  void release_all();

  /// The next message for the node; none when there is none, or it waits for one before it.
  std::optional<Arrival> take(Clock::time_point now);

  /// When take() will have one [ms]; none while nothing waits.
  std::optional<int> ms_until_next(Clock::time_point now) const;

  std::size_t size() const { return ready_.size() + num_parked_; }
  std::int64_t num_dropped() const { return num_dropped_; }

 private:
  struct Lane {
    std::optional<std::int32_t> last_seq;  ///< of those that went on
    std::vector<Arrival> parked;           ///< in order of seq
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
