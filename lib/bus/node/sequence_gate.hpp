// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "bus/messages/channel.hpp"

namespace orchard::bus {

/// What the sequence numbers and times of arriving messages said.
struct SequenceCounts {
  std::int64_t num_lost = 0;       ///< missing by seq
  std::int64_t num_duplicate = 0;  ///< came before, or too old to tell
  std::int64_t num_reordered = 0;  ///< came behind a later one, and are not counted lost
  std::int64_t num_leaps = 0;      ///< refused: their time or number leaps, and nothing agreed
  std::int64_t num_restarts = 0;   ///< a source began again, or its clock was set
  std::int64_t num_contests = 0;   ///< signs of a second source on the channel
  double clock_change_s = 0.0;     ///< by how much a clock was last set, beyond kLeap_us
};

/// What is to be done with a message.
enum class GateDecision {
  kNew,        ///< it is used
  kReordered,  ///< it is used where order is made afterwards (a log), and comes too late live
  kDuplicate,  ///< it is dropped: it came before, or disagrees with those held
  kHeld,       ///< it leaps: it is kept aside, and so are those before it that num_held() counts
  kBelieved,   ///< it agrees with those held: they are used, in their order, and then it
};

/// Decides per channel whether a message is new. The same rule holds live, in the order of
/// arrival, and for a log, in the order of the file: so both use the same messages.
///
/// New is a higher seq that is not earlier in time. A seq that falls to a beginning while time goes
/// on is a source that was started again. No single message is believed about more: a leap of more
/// than a minute or of 100,000 in seq, or a time that goes back, is taken when kNumToBelieve
/// messages in a row agree on it, when the other channels are at that time already, or when as much
/// time has passed where the messages arrive: a robot that pauses.
///
/// Where arrivals are told, so does one that comes earlier than its channel keeps its time: by as
/// long as kNumToBelieve of its messages take, at most two seconds, after what the medians of the
/// last ones let expect, which none alone moves. So does one whose number goes on by more than its
/// time does at the channel's own rate. What was kept aside and lies between two that are new was
/// right.
class SequenceGate {
 public:
  static constexpr std::int64_t kLeap_us = 60'000'000;
  static constexpr std::int32_t kLeap_seq = 100'000;
  static constexpr int kNumToBelieve = 5;

  /// `arrival_us`: when it arrived, by any one clock of the receiver [us] (in a log: when it was
  /// recorded); none where that says nothing of the source's time.
  GateDecision accept(Channel channel, std::int32_t seq, std::int64_t utime,
                      std::optional<std::int64_t> arrival_us = std::nullopt);

  /// How many of the newest messages of the channel wait for others to agree.
  int num_held(Channel channel) const { return last_[index(channel)].num_held; }

  /// Which run of its source the newest message of the channel belongs to: +1 with every restart.
  std::int32_t run(Channel channel) const { return last_[index(channel)].run; }

  /// There will be no more: what is held is refused, and counted so.
  void finish();

  const SequenceCounts& counts(Channel channel) const { return counts_[index(channel)]; }
  /// Of all channels; clock_change_s is the largest.
  SequenceCounts counts() const;

 private:
  struct Stamp {
    std::int32_t seq = 0;
    std::int64_t utime = 0;
    std::optional<std::int64_t> arrival_us;
  };
  /// How a channel keeps its time, by what was accepted last.
  class Pace {
   public:
    /// One that was accepted after `before`; both of one run.
    void note(const Stamp& before, const Stamp& stamp);
    void forget() { num_ = 0; }
    /// Whether it comes so early that others must agree.
    bool is_early(const Stamp& last, const Stamp& next) const;
    /// The same of its number for its time.
    bool skips(const Stamp& last, const Stamp& next) const;

   private:
    static constexpr std::size_t kRecent = 31;
    struct Step {
      std::int64_t lead_us = 0;    ///< time of measurement less that of arrival
      std::int64_t period_us = 0;  ///< between two messages of the source
    };
    std::int64_t median(std::int64_t Step::*of) const;
    std::array<Step, kRecent> steps_{};
    std::size_t num_ = 0;  ///< ever since forget()
  };
  struct Seen {
    Stamp stamp;
    std::int32_t run = 0;  ///< of which run of the source; 0: none was seen here
  };
  struct Last {
    bool seen = false;
    Stamp stamp;
    std::int32_t first_seq = 0;   ///< of its run
    std::int32_t run = 0;         ///< +1 with every restart
    std::int64_t order = 0;       ///< when it was accepted, counted in accepted messages
    std::vector<Seen> history;    ///< by seq modulo its size
    std::optional<Stamp> before;  ///< where the source was before its last restart
    std::int64_t restart_order = 0;
    bool contested = false;  ///< the source before a restart is there still
    int num_held = 0;
    int num_against = 0;         ///< that did not agree with them, since the last that did
    int num_held_old = 0;        ///< of those, the ones that look like duplicates
    Stamp held;                  ///< the newest of them
    std::optional<Stamp> rival;  ///< the newest that was held and refused
    Stamp held_first;            ///< the oldest that is held
    Pace pace;
  };

  static std::size_t index(Channel channel) { return static_cast<std::size_t>(channel); }
  static bool follows(const Stamp& last, const Stamp& next);
  static bool is_pause(const Stamp& last, const Stamp& next);
  bool others_are_at(Channel channel, std::int64_t utime) const;
  bool goes_on(Channel channel, const Stamp& next) const;
  bool is_other_source(const Last& last, const Stamp& next) const;
  bool fills_gap(const Last& last, const Stamp& late, bool& was_lost) const;
  GateDecision hold(Channel channel, const Stamp& stamp, bool is_time_known);
  void drop_held(Channel channel);
  void take(Last& last, const Stamp& stamp);
  void remember(Last& last, const Stamp& stamp);
  void begin_again(Channel channel, const Stamp& stamp);

  std::array<Last, kNumChannels> last_;
  std::array<SequenceCounts, kNumChannels> counts_;
  std::int64_t num_accepted_ = 0;
};

}  // namespace orchard::bus
