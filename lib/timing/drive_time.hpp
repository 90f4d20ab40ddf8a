// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <optional>
#include <vector>

namespace orchard::timing {

// Drive time [us] orders the messages of a drive although its clocks are set: it is the utime of a
// message plus kEpoch_us for each time that the clocks were set back before. Between two settings
// it is as good as utime; nodes know no other time, and utime alone is on the bus and in files.

/// physical: utime is below 2200-01-01 [us], so that every epoch comes after the one before it.
inline constexpr std::int64_t kEpoch_us = 7'258'118'400'000'000;

/// derived: drive time stays within 64 bits.
inline constexpr std::int64_t kEpochsMax = std::numeric_limits<std::int64_t>::max() / kEpoch_us;

inline std::int64_t epoch_of(std::int64_t drive_time) { return drive_time / kEpoch_us; }
/// What a message tells: the time by the clock of its sender.
inline std::int64_t utime_of(std::int64_t drive_time) { return drive_time % kEpoch_us; }
/// None passes where a clock was set back: nobody knows how long that took.
inline std::int64_t elapsed_us(std::int64_t from, std::int64_t to) {
  return epoch_of(from) == epoch_of(to) ? to - from : 0;
}

/// Tells the epoch of messages of several kinds, whatever the order of arrival between the kinds. A
/// kind whose own time falls was set back. The first that is opens an epoch; the others follow when
/// their time is nearer to that epoch's than to that of the one they are in, which includes those
/// that were silent meanwhile. So kinds that still have the old clock stay where they are.
class DriveClock {
 public:
  /// derived: A smaller fall is no new epoch, and what repeats the time is late: kinds that arrive
  /// half as far apart as the fall could not be told from each other. A link that catches up after
  /// a second must not confuse them.
  static constexpr std::int64_t kSetBack_us = 2'000'000;

  explicit DriveClock(std::size_t num_kinds) : kinds_(num_kinds) {}

  /// Goes on after a message of this kind and drive time, as after a restart of the process.
  void resume(std::size_t kind, std::int64_t drive_time) {
    const auto epoch = static_cast<std::size_t>(epoch_of(drive_time));
    const std::int64_t utime = utime_of(drive_time);
    if (newest_.size() <= epoch) newest_.resize(epoch + 1, utime);
    newest_[epoch] = std::max(newest_[epoch], utime);
    kinds_[kind] = {utime, epoch};
  }

  /// The drive time of the next message of a kind; none if an earlier message of the kind had a
  /// later time.
  std::optional<std::int64_t> next(std::size_t kind, std::int64_t utime) {
    Kind& own = kinds_[kind];
    const std::size_t epoch = epoch_of_next(own, utime);
    if (epoch == newest_.size()) newest_.push_back(utime);
    newest_[epoch] = std::max(newest_[epoch], utime);
    if (epoch == own.epoch && own.utime && utime < *own.utime) return std::nullopt;
    own = {utime, epoch};
    return same_epoch(kind, utime);
  }

  /// The drive time of a message of the epoch in which its kind is.
  std::int64_t same_epoch(std::size_t kind, std::int64_t utime) const {
    return static_cast<std::int64_t>(kinds_[kind].epoch) * kEpoch_us + utime;
  }

  /// Whether a time that falls is that of an epoch which another kind has opened.
  bool is_followed(std::size_t kind, std::int64_t utime) const {
    const Kind& own = kinds_[kind];
    const std::size_t epoch = epoch_of_next(own, utime);
    return epoch > own.epoch && epoch < newest_.size();
  }

 private:
  struct Kind {
    std::optional<std::int64_t> utime;  ///< the newest of its epoch
    std::size_t epoch = 0;
  };

  /// newest_.size(): one that begins now.
  std::size_t epoch_of_next(const Kind& own, std::int64_t utime) const {
    if (newest_.empty()) return 0;
    const bool is_set_back = own.utime && *own.utime - utime > kSetBack_us;
    const std::int64_t near_us =
        is_set_back ? (*own.utime - utime) / 2 : std::llabs(utime - newest_[own.epoch]);
    for (std::size_t epoch = newest_.size() - 1; epoch > own.epoch; --epoch) {
      if (std::llabs(utime - newest_[epoch]) <= near_us) return epoch;
    }
    const bool is_full = newest_.size() == static_cast<std::size_t>(kEpochsMax);
    return is_set_back && !is_full ? newest_.size() : own.epoch;
  }

  std::vector<Kind> kinds_;
  std::vector<std::int64_t> newest_;  ///< utime of each epoch
};

/// Joins the epochs to one time that passes as for a body that does not stop when a clock is set.
/// The first kind that is heard in the new epoch comes as long after its last message as that came
/// after the one before.
template <std::size_t kNumKinds>
class SteadyTime {
 public:
  /// The steady time of the next item; items come in order of drive time.
  std::int64_t next(std::size_t kind, std::int64_t drive_time) {
    Kind& own = kinds_[kind];
    if (joints_.empty() || epoch_of(drive_time) != epoch_of(last_ + joints_.back().ahead_us)) {
      const std::int64_t begin =
          joints_.empty() ? drive_time : std::max(last_ + 1, own.last + own.period_us);
      joints_.push_back({begin, drive_time - begin});
    }
    last_ = drive_time - joints_.back().ahead_us;
    own = {last_, own.last == 0 ? 0 : last_ - own.last};
    return last_;
  }

  /// The drive time of a steady time that next() has given, or of one between two.
  std::int64_t drive_time(std::int64_t steady) const {
    const auto after = std::find_if(joints_.rbegin(), joints_.rend(),
                                    [steady](const Joint& joint) { return joint.begin <= steady; });
    return after == joints_.rend() ? steady : steady + after->ahead_us;
  }

 private:
  struct Joint {
    std::int64_t begin;     ///< steady time of the first item of an epoch
    std::int64_t ahead_us;  ///< of drive time before steady time
  };
  struct Kind {
    std::int64_t last = 0;  ///< 0: none yet
    std::int64_t period_us = 0;
  };
  std::array<Kind, kNumKinds> kinds_{};
  std::vector<Joint> joints_;
  std::int64_t last_ = 0;
};

}  // namespace orchard::timing
