// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "bus/messages/channel.hpp"
#include "timing/drive_time.hpp"

namespace orchard::bus {

/// Counters derived from the sequence numbers and times of arriving messages.
struct SequenceCounts {
  std::int64_t num_lost = 0;       ///< missing by seq
  std::int64_t num_duplicate = 0;  ///< received before, or too old to tell
  std::int64_t num_reordered = 0;  ///< arrived after a later message; not counted as lost
  std::int64_t num_jumps = 0;     ///< refused: time or seq jumps, and no other message confirmed it
  std::int64_t num_restarts = 0;  ///< the source was restarted, or its clock was set
  std::int64_t num_second_source_signs = 0;  ///< indications of a second source on the channel
  double clock_change_s = 0.0;  ///< last step of a source's clock: an epoch, or more than kJump_us
};

/// What to do with a message.
enum class GateDecision {
  kNew,        ///< use it
  kReordered,  ///< use it in a log, where messages are sorted afterwards; too late when live
  kDuplicate,  ///< drop it: received before, or contradicts the held messages
  kHeld,       ///< hold it: it jumps. Keep the newest num_held() held messages
  kConfirmed,  ///< it agrees with the held messages: use those in order, then this one
};

/// Decides per channel whether a message is new. The rule is the same live (order of arrival) and
/// for a log (order in the file), so both use the same messages.
///
/// A message is new if its seq is higher and its utime is not earlier. A seq that falls to a low
/// number while time continues means that the source was restarted. Any other jump needs
/// confirmation: more than kJump_us or kJump_seq, or a utime that goes back. It is accepted once
/// kNumToConfirm messages in a row agree on it, if the other channels are already at that time, or
/// if as much time has passed at the receiver (the robot paused). It is refused as long as other
/// channels stay at the old time and none comes along: clocks of one robot are set together.
///
/// If arrival times are known, two more cases need confirmation: a utime that is ahead of the
/// channel's pace by more than kNumToConfirm periods (at most two seconds), and a seq that grows
/// faster than the utime at the channel's rate. The pace is the median of recent messages, so no
/// single message shifts it. Held messages that lie between two new ones are accepted.
class SequenceGate {
 public:
  static constexpr std::int64_t kJump_us = 60'000'000;
  static constexpr std::int32_t kJump_seq = 100'000;
  static constexpr int kNumToConfirm = 5;
  static constexpr int kNumAlone = 100;  ///< meanwhile every sensor is heard

  /// Classifies one message. `arrival_us`: time of arrival on any one clock of the receiver [us]
  /// (in a log: time of recording); none where it is unrelated to the source's time.
  GateDecision accept(Channel channel, std::int32_t seq, std::int64_t utime,
                      std::optional<std::int64_t> arrival_us = std::nullopt);

  /// Whether another channel has just confirmed the held messages of this one: use them in order.
  bool confirm_held(Channel channel);

  /// Number of the newest messages of the channel that wait for confirmation.
  int num_held(Channel channel) const { return last_[index(channel)].num_held(); }

  /// The drive time of a message that is used, in the order of use; none for one to be dropped,
  /// because its channel was at a later time already: the clock was set back a little.
  std::optional<std::int64_t> drive_time(Channel channel, std::int64_t utime) {
    return clock_.next(index(channel), utime);
  }
  /// The same for a message that was kReordered.
  std::int64_t drive_time_of_reordered(Channel channel, std::int64_t utime) const {
    return clock_.same_epoch(index(channel), utime);
  }
  /// Goes on after a message that an earlier process has used.
  void resume(Channel channel, std::int64_t drive_time) {
    clock_.resume(index(channel), drive_time);
  }

  /// Run of the source that the newest message of the channel belongs to; +1 with every restart.
  std::int32_t run(Channel channel) const { return last_[index(channel)].run; }

  /// Ends the input: held messages are refused and counted as such.
  void finish();

  const SequenceCounts& counts(Channel channel) const { return counts_[index(channel)]; }
  /// Sums over all channels; clock_change_s is the largest.
  SequenceCounts counts() const;

 private:
  struct Stamp {
    std::int32_t seq = 0;
    std::int64_t utime = 0;
    std::optional<std::int64_t> arrival_us;
  };
  /// Timing of a channel, estimated from the messages accepted last.
  class Pace {
   public:
    /// Adds an accepted message; `before` is the previous one of the same run.
    void note(const Stamp& before, const Stamp& stamp);
    void forget() { num_ = 0; }
    /// Whether the utime is so far ahead that the message needs confirmation.
    bool is_early(const Stamp& last, const Stamp& next) const;
    /// Whether the seq grows so much faster than the utime that the message needs confirmation.
    bool skips(const Stamp& last, const Stamp& next) const;

   private:
    static constexpr std::size_t kRecent = 31;
    struct Step {
      std::int64_t lead_us = 0;    ///< utime minus time of arrival
      std::int64_t period_us = 0;  ///< between two messages of the source
    };
    std::int64_t median_period_us() const;
    std::array<Step, kRecent> steps_{};
    std::size_t num_ = 0;                ///< steps since forget()
    std::int64_t expected_lead_us_ = 0;  ///< of the next message, from kStepsMin steps on
  };
  struct Seen {
    Stamp stamp;
    std::int32_t run = 0;  ///< run of the source; 0: no message here
  };
  struct Last {
    bool seen = false;
    Stamp stamp;
    std::int32_t first_seq = 0;         ///< first seq of the run
    std::int32_t run = 0;               ///< +1 with every restart
    std::int64_t order = 0;             ///< number of accepted messages when this one was accepted
    std::vector<Seen> history;          ///< indexed by seq modulo its size
    std::optional<Stamp> before;        ///< last message before the last restart
    std::int32_t before_first_seq = 0;  ///< first seq of the run of `before`
    std::int64_t restart_order = 0;
    bool contested = false;       ///< the source from before the restart still sends
    std::vector<Stamp> held;      ///< messages that wait for confirmation, in order of seq
    int num_against = 0;          ///< contradictions of the held messages since the last agreement
    std::int64_t held_order = 0;  ///< number of accepted messages when the first was held
    int num_held_old = 0;         ///< held messages that look like duplicates
    std::optional<Stamp> rival;   ///< newest held message that was refused
    Pace pace;

    int num_held() const { return static_cast<int>(held.size()); }
  };

  static std::size_t index(Channel channel) { return static_cast<std::size_t>(channel); }
  static bool follows(const Stamp& last, const Stamp& next);
  static bool is_pause(const Stamp& last, const Stamp& next);
  bool others_are_at(Channel channel, std::int64_t utime) const;
  bool is_contradicted(const Last& last) const;
  bool goes_on(Channel channel, const Stamp& next) const;
  bool is_other_source(const Last& last, const Stamp& next) const;
  bool fills_gap(const Last& last, const Stamp& late, bool& was_lost) const;
  bool is_set_with_others(Channel channel, std::int64_t utime) const;
  GateDecision hold(Channel channel, const Stamp& stamp, bool is_time_known);
  void take_held(Channel channel);
  void drop_held(Channel channel);
  void take(Last& last, const Stamp& stamp);
  void take_confirmed(Last& last);
  void remember(Last& last, const Stamp& stamp);
  void begin_again(Channel channel, const Stamp& stamp);

  std::array<Last, kNumChannels> last_;
  std::array<SequenceCounts, kNumChannels> counts_;
  std::int64_t num_accepted_ = 0;
  timing::DriveClock clock_{kNumChannels};
};

}  // namespace orchard::bus
