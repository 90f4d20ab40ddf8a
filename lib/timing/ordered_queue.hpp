// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <utility>

#include "timing/drive_time.hpp"

namespace orchard::timing {

/// Merges items of several kinds into one sequence ordered by time, independent of the order in
/// which the kinds arrive, and reports the kind that holds the next item back.
///
/// An item is released once every kind with a `wait_us` has reached its time, or once message time
/// is more than the missing kind's `wait_us` ahead of it. Times are message times [us]. At equal
/// times the kind with the lower number comes first; within a kind, the earlier arrival.
template <class Item, std::size_t kNumKinds>
class OrderedQueue {
 public:
  /// Earlier than any time.
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::min();

  struct Rule {
    std::optional<std::int64_t> wait_us;  ///< how long other kinds wait for this one; none: never
    bool tells_time = true;               ///< whether its arrivals advance message time
  };
  using Rules = std::array<Rule, kNumKinds>;

  explicit OrderedQueue(const Rules& rules) : rules_(rules) { reached_.fill(kNever); }

  /// Records the time of an arrival without queueing it.
  void reach(std::size_t kind, std::int64_t utime) {
    reached_[kind] = std::max(reached_[kind], utime);
    if (!rules_[kind].tells_time || utime <= message_time_) return;
    if (message_time_ != kNever && utime - message_time_ > kLeap_us) {
      before_leap_ = message_time_;
      leap_us_ = utime - message_time_;
    }
    message_time_ = utime;
  }
  /// The newest time of a kind; kNever before its first.
  std::int64_t reached(std::size_t kind) const { return reached_[kind]; }
  /// The newest time of all kinds with `tells_time`; kNever before the first.
  std::int64_t message_time() const { return message_time_; }

  /// Changes how long items of other kinds wait for this kind; none: not at all.
  void set_wait(std::size_t kind, std::optional<std::int64_t> wait_us) {
    rules_[kind].wait_us = wait_us;
  }

  /// Queues an item behind the queued ones of its kind with the same or an earlier time.
  void push(std::size_t kind, std::int64_t utime, Item item) {
    reach(kind, utime);
    std::deque<Entry>& queue = queues_[kind];
    const auto after =
        std::upper_bound(queue.begin(), queue.end(), utime,
                         [](std::int64_t time, const Entry& entry) { return time < entry.utime; });
    queue.insert(after, Entry{utime, std::move(item)});
  }

  bool is_empty(std::size_t kind) const { return queues_[kind].empty(); }
  std::size_t size(std::size_t kind) const { return queues_[kind].size(); }
  /// The earliest item of a kind and its time; the kind's queue must not be empty.
  const Item& front(std::size_t kind) const { return queues_[kind].front().item; }
  std::int64_t front_utime(std::size_t kind) const { return queues_[kind].front().utime; }

  /// Removes and returns the earliest item of a kind, even if blocker() would hold it back.
  Item take(std::size_t kind) {
    Item item = std::move(queues_[kind].front().item);
    queues_[kind].pop_front();
    return item;
  }

  /// The kind of the next item in order; none when the queue is empty.
  std::optional<std::size_t> next_kind() const {
    std::optional<std::size_t> next;
    for (std::size_t kind = 0; kind < kNumKinds; ++kind) {
      if (is_empty(kind)) continue;
      if (!next || front_utime(kind) < front_utime(*next)) next = kind;
    }
    return next;
  }
  std::optional<std::int64_t> next_utime() const {
    const std::optional<std::size_t> next = next_kind();
    if (!next) return std::nullopt;
    return front_utime(*next);
  }

  /// The lowest-numbered kind that an item of this time waits for; none when the item can be
  /// released. `needed_utime(kind)` is the time that each kind must have reached.
  template <class NeededUtime>
  std::optional<std::size_t> blocker(std::int64_t utime, const NeededUtime& needed_utime) const {
    for (std::size_t kind = 0; kind < kNumKinds; ++kind) {
      const std::optional<std::int64_t>& wait_us = rules_[kind].wait_us;
      if (!wait_us || reached_[kind] >= needed_utime(kind)) continue;
      if (waited_us(utime) <= *wait_us) return kind;
    }
    return std::nullopt;
  }
  /// The same when every kind must have reached the item's own time.
  std::optional<std::size_t> blocker(std::int64_t utime) const {
    return blocker(utime, [utime](std::size_t) { return utime; });
  }

  /// Removes and returns the next item in order; none when the queue is empty or the item must
  /// wait.
  std::optional<Item> pop() {
    const std::optional<std::size_t> next = next_kind();
    if (!next || blocker(front_utime(*next))) return std::nullopt;
    return take(*next);
  }
  /// The same at the end of the input, without waiting.
  std::optional<Item> pop_flushed() {
    const std::optional<std::size_t> next = next_kind();
    if (!next) return std::nullopt;
    return take(*next);
  }

 private:
  /// derived: only an epoch is longer. Where message time leaps to the next one, a clock was set
  /// back: nobody has waited meanwhile, and the kinds that still have the old clock are waited for
  /// as before.
  static constexpr std::int64_t kLeap_us = kEpoch_us / 2;

  std::int64_t waited_us(std::int64_t utime) const {
    const bool is_before = before_leap_ != kNever && utime - before_leap_ < leap_us_ / 2;
    return message_time_ - utime - (is_before ? leap_us_ : 0);
  }

  struct Entry {
    std::int64_t utime = 0;
    Item item;
  };

  Rules rules_;
  std::array<std::deque<Entry>, kNumKinds> queues_;
  std::array<std::int64_t, kNumKinds> reached_;
  std::int64_t message_time_ = kNever;
  std::int64_t before_leap_ = kNever;  ///< message time before its last leap
  std::int64_t leap_us_ = 0;
};

}  // namespace orchard::timing
