// SPDX-License-Identifier: BSD-3-Clause
#include "bus/node/sequence_gate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

namespace orchard::bus {
namespace {

/// Messages remembered per channel to detect duplicates and gaps: one minute of the fastest wheel
/// odometry.
constexpr std::int32_t kHistory = 4096;

/// Max distance in seq at which neighbours of a missing message are searched.
constexpr std::int32_t kNeighbours = 64;

/// Max time by which a late message may precede its next neighbour when it has no earlier
/// neighbour, as at the start of a source.
constexpr std::int64_t kBeforeFirst_us = 1'000'000;

/// Max lead over the expected time without confirmation, however slow the channel is. A link that
/// catches up skips less.
constexpr std::int64_t kAheadMax_us = 2'000'000;

/// A seq may grow this many times faster than the channel's rate: that rate may have been estimated
/// while the source was slow.
constexpr std::int64_t kRateMax = 4;

/// Min number of steps from which the pace of a channel is known.
constexpr std::size_t kStepsMin = 7;

/// Longest pause of a robot in a drive; a larger jump needs confirmation.
constexpr std::int64_t kPauseMax_us = std::int64_t{4} * 3600 * 1'000'000;

/// After this many messages of other channels, a silent channel no longer tells the current time.
constexpr std::int64_t kTimeGoodFor = 1000;

/// Two sources on one channel: one continues within kNearSeq of its last seq while the other is
/// more than kFarSeq away.
constexpr std::int32_t kNearSeq = 100;
constexpr std::int32_t kFarSeq = 1000;

/// A restart within this many accepted messages of the previous one, at a seq that is not a first
/// one, indicates two sources.
constexpr std::int64_t kRestartsApart = 50;

/// Expected lead of the next message. The clocks of source and receiver may run at different rates
/// (a simulation played fast), so the difference between the medians of the older and newer half of
/// the steps is extrapolated. `steps` is a ring buffer to which `num` steps were written.
template <class Steps>
std::int64_t expected_lead_us(const Steps& steps, std::size_t num) {
  const std::size_t half = std::min(num, steps.size()) / 2;
  const auto median_from = [&](std::size_t newest) {
    std::array<std::int64_t, std::tuple_size_v<Steps>> leads_us;
    std::size_t at = (num - 1 - newest) % steps.size();
    for (std::size_t i = 0; i < half; ++i) {
      leads_us[i] = steps[at].lead_us;
      at = at > 0 ? at - 1 : steps.size() - 1;
    }
    const auto begin = leads_us.begin(), middle = begin + static_cast<std::ptrdiff_t>(half / 2);
    std::nth_element(begin, middle, begin + static_cast<std::ptrdiff_t>(half));
    return *middle;
  };
  const std::int64_t newer_us = median_from(0), older_us = median_from(half);
  const auto halves = static_cast<std::int64_t>(half);
  return newer_us + (newer_us - older_us) * (halves + 1) / (2 * halves);
}

}  // namespace

bool SequenceGate::follows(const Stamp& last, const Stamp& next) {
  return next.seq > last.seq && next.seq - last.seq <= kJump_seq && next.utime >= last.utime &&
         next.utime - last.utime <= kJump_us;
}

/// Whether as much time has passed at the receiver as the time stamps say.
bool SequenceGate::is_pause(const Stamp& last, const Stamp& next) {
  if (!last.arrival_us || !next.arrival_us) return false;
  const std::int64_t passed_us = next.utime - last.utime;
  return passed_us > 0 && passed_us <= kPauseMax_us &&
         std::abs(*next.arrival_us - *last.arrival_us - passed_us) <= kJump_us;
}

void SequenceGate::Pace::note(const Stamp& before, const Stamp& stamp) {
  if (!before.arrival_us || !stamp.arrival_us || stamp.seq <= before.seq) return;
  const std::int64_t lead_us = stamp.utime - *stamp.arrival_us;
  const bool is_clock_set =
      num_ >= kStepsMin && std::abs(lead_us - expected_lead_us_) > kAheadMax_us;
  if (is_clock_set) num_ = 0;
  steps_[num_++ % kRecent] = {lead_us, (stamp.utime - before.utime) / (stamp.seq - before.seq)};
  if (num_ >= kStepsMin) expected_lead_us_ = bus::expected_lead_us(steps_, num_);
}

std::int64_t SequenceGate::Pace::median_period_us() const {
  std::array<std::int64_t, kRecent> values{};
  const auto end = values.begin() + static_cast<std::ptrdiff_t>(std::min(num_, kRecent));
  std::transform(steps_.begin(), steps_.begin() + (end - values.begin()), values.begin(),
                 [](const Step& step) { return step.period_us; });
  const auto middle = values.begin() + (end - values.begin()) / 2;
  std::nth_element(values.begin(), middle, end);
  return *middle;
}

bool SequenceGate::Pace::is_early(const Stamp& last, const Stamp& next) const {
  if (!last.arrival_us || !next.arrival_us) return false;
  const std::int64_t lead_us = next.utime - *next.arrival_us;
  if (num_ < kStepsMin) return lead_us - (last.utime - *last.arrival_us) > kAheadMax_us;
  const std::int64_t early_us = lead_us - expected_lead_us_;
  if (early_us <= 0 || early_us > kAheadMax_us) return early_us > 0;  // few messages are between
  const std::int64_t period_us = median_period_us();
  return period_us > 0 && early_us > kNumToConfirm * period_us;
}

bool SequenceGate::Pace::skips(const Stamp& last, const Stamp& next) const {
  const std::int64_t num_skipped = std::int64_t{next.seq} - last.seq - kNumToConfirm;
  if (num_ < kStepsMin || num_skipped <= 0) return false;
  return num_skipped * median_period_us() > kRateMax * (next.utime - last.utime);
}

bool SequenceGate::others_are_at(Channel channel, std::int64_t utime) const {
  for (std::size_t i = 0; i < last_.size(); ++i) {
    const Last& other = last_[i];
    if (i == index(channel) || !other.seen || num_accepted_ - other.order > kTimeGoodFor) continue;
    if (std::abs(other.stamp.utime - utime) <= kJump_us) return true;
  }
  return false;
}

/// Whether other channels keep the clock that a channel has left, and none has left it likewise.
/// They are given kNumAlone messages to be heard.
bool SequenceGate::is_contradicted(const Last& last) const {
  const std::int64_t near_us = std::abs(last.held.front().utime - last.stamp.utime) / 2;
  if (!last.seen || near_us < timing::DriveClock::kSetBack_us / 2) return false;
  const std::int64_t here = last.held.back().utime;
  const std::int64_t by_old_clock = last.stamp.utime + here - last.held.front().utime;
  bool is_kept = false;
  for (const Last& other : last_) {
    if (&other == &last || !other.seen) continue;
    const auto is_at = [&](const Stamp& stamp, std::int64_t utime) {
      return std::abs(stamp.utime - utime) <= near_us;
    };
    if (is_at(other.stamp, here) || (!other.held.empty() && is_at(other.held.back(), here)))
      return false;
    const bool is_heard = other.order > last.held_order;
    const bool may_be_heard =
        last.num_held() < kNumAlone && num_accepted_ - other.order <= kTimeGoodFor;
    is_kept = is_kept || ((is_heard || may_be_heard) && is_at(other.stamp, by_old_clock));
  }
  return is_kept;
}

bool SequenceGate::goes_on(Channel channel, const Stamp& next) const {
  const Stamp& last = last_[index(channel)].stamp;
  const Pace& pace = last_[index(channel)].pace;
  if (follows(last, next)) return !pace.is_early(last, next) && !pace.skips(last, next);
  // After a silence of this channel alone, the other channels tell the time; after a silence of all
  // channels, the receiver's clock does.
  return next.seq > last.seq && next.seq - last.seq <= kJump_seq && next.utime >= last.utime &&
         (others_are_at(channel, next.utime) || is_pause(last, next));
}

bool SequenceGate::is_other_source(const Last& last, const Stamp& next) const {
  return last.before && follows(*last.before, next) && next.seq - last.before->seq <= kNearSeq &&
         next.seq - last.stamp.seq > kFarSeq;
}

/// Whether the source sent the message between two received ones, by seq and by utime.
bool SequenceGate::fills_gap(const Last& last, const Stamp& late, bool& was_lost) const {
  if (late.seq >= last.stamp.seq || last.stamp.seq - late.seq >= kHistory) return false;
  const auto at = [&](std::int32_t seq) -> const Seen* {
    if (seq < 0) return nullptr;
    const Seen& seen = last.history[static_cast<std::size_t>(seq % kHistory)];
    return seen.run == last.run && seen.stamp.seq == seq ? &seen : nullptr;
  };
  if (at(late.seq) != nullptr) return false;
  const Seen* above = nullptr;
  const Seen* below = nullptr;
  for (std::int32_t i = 1; i <= kNeighbours && above == nullptr; ++i) above = at(late.seq + i);
  for (std::int32_t i = 1; i <= kNeighbours && below == nullptr; ++i) below = at(late.seq - i);
  if (above == nullptr || above->stamp.utime < late.utime) return false;
  was_lost = late.seq > last.first_seq;
  return below != nullptr ? below->stamp.utime <= late.utime
                          : above->stamp.utime - late.utime <= kBeforeFirst_us;
}

GateDecision SequenceGate::accept(Channel channel, std::int32_t seq, std::int64_t utime,
                                  std::optional<std::int64_t> arrival_us) {
  Last& last = last_[index(channel)];
  SequenceCounts& counts = counts_[index(channel)];
  const Stamp stamp{seq, utime, arrival_us};
  if (!last.seen) {
    return hold(channel, stamp, num_accepted_ == 0 || others_are_at(channel, utime));
  }
  const Seen& same = last.history[static_cast<std::size_t>(std::max(seq, 0) % kHistory)];
  if (same.run > 0 && same.stamp.seq == seq && same.stamp.utime == utime) {
    ++counts.num_duplicate;
    return GateDecision::kDuplicate;
  }
  if (is_other_source(last, stamp)) {
    // The apparent restart is a second source; the first one continues.
    last.stamp = *std::exchange(last.before, std::nullopt);
    last.first_seq = last.before_first_seq;
    last.contested = true;
    ++counts.num_second_source_signs;
  }
  if (goes_on(channel, stamp)) {
    const int num_right = last.num_held() - last.num_held_old;
    if (num_right > 0 && follows(last.held.back(), stamp) &&
        (follows(last.stamp, last.held.front()) || !follows(last.stamp, stamp))) {
      // The source or the other channels have reached the time of the held messages, which confirms
      // them.
      counts.num_lost += std::max(0, seq - last.stamp.seq - 1 - last.num_held());
      take_confirmed(last);
      take(last, stamp);
      return GateDecision::kConfirmed;
    }
    drop_held(channel);
    counts.num_lost += seq - last.stamp.seq - 1;
    take(last, stamp);
    return GateDecision::kNew;
  }
  bool was_lost = false;
  if (utime <= last.stamp.utime && fills_gap(last, stamp, was_lost)) {
    if (was_lost) --counts.num_lost;
    ++counts.num_reordered;
    remember(last, stamp);
    return GateDecision::kReordered;
  }
  const bool time_goes_on = utime > last.stamp.utime && utime - last.stamp.utime <= kJump_us;
  if (!last.contested && time_goes_on && seq <= last.stamp.seq && seq < kNearSeq &&
      !last.pace.is_early(last.stamp, stamp)) {
    drop_held(channel);
    begin_again(channel, stamp);
    return GateDecision::kNew;
  }
  return hold(channel, stamp, !last.contested && is_set_with_others(channel, utime));
}

/// Whether the clock of a channel was set to a time at which other channels are already.
bool SequenceGate::is_set_with_others(Channel channel, std::int64_t utime) const {
  const std::int64_t last_utime = last_[index(channel)].stamp.utime;
  return clock_.is_followed(index(channel), utime) ||
         (std::abs(utime - last_utime) > kJump_us && others_are_at(channel, utime) &&
          !others_are_at(channel, last_utime));
}

bool SequenceGate::confirm_held(Channel channel) {
  const Last& last = last_[index(channel)];
  if (last.held.empty() || !last.seen || last.contested ||
      !is_set_with_others(channel, last.held.front().utime)) {
    return false;
  }
  take_held(channel);
  return true;
}

/// Holds a message together with those it agrees with, until they are enough or the other channels
/// confirm their time.
GateDecision SequenceGate::hold(Channel channel, const Stamp& stamp, bool is_time_known) {
  Last& last = last_[index(channel)];
  if (!last.held.empty() && stamp.seq == last.held.back().seq &&
      stamp.utime == last.held.back().utime) {
    ++counts_[index(channel)].num_duplicate;
    return GateDecision::kDuplicate;
  }
  if (!last.held.empty() && !follows(last.held.back(), stamp)) {
    // If several messages agree, one that disagrees is refused, but only a limited number of times.
    if (last.num_held() > 1 && ++last.num_against < kNumToConfirm) {
      ++counts_[index(channel)].num_jumps;
      return GateDecision::kDuplicate;
    }
    drop_held(channel);
  }
  last.num_against = 0;
  if (last.held.empty()) last.held_order = num_accepted_;
  last.held.push_back(stamp);
  // Single messages were refused one by one and yet continue each other: another source sends them.
  const bool goes_on_beside = last.num_held() == 1 && last.rival && follows(*last.rival, stamp) &&
                              stamp.seq - last.rival->seq <= kNearSeq;
  if (goes_on_beside) ++counts_[index(channel)].num_second_source_signs;
  if (last.seen && stamp.seq <= last.stamp.seq && stamp.utime <= last.stamp.utime &&
      last.stamp.utime - stamp.utime <= kJump_us) {
    ++last.num_held_old;
  }
  if (last.contested) ++counts_[index(channel)].num_second_source_signs;
  if (!is_time_known && (last.num_held() < kNumToConfirm || is_contradicted(last))) {
    if (last.num_held() > kNumAlone) drop_held(channel);
    return GateDecision::kHeld;
  }
  const bool alone = last.num_held() == 1;
  take_held(channel);
  return alone ? GateDecision::kNew : GateDecision::kConfirmed;
}

void SequenceGate::take_held(Channel channel) {
  Last& last = last_[index(channel)];
  const Stamp stamp = last.held.back();
  if (last.seen && follows(last.stamp, stamp)) {  // a jump ahead, and the source stays there
    counts_[index(channel)].num_lost += std::max(0, stamp.seq - last.stamp.seq - last.num_held());
    last.pace.forget();
    take(last, stamp);
  } else {
    begin_again(channel, stamp);
    last.before.reset();
    last.contested = false;
  }
  take_confirmed(last);
}

void SequenceGate::drop_held(Channel channel) {
  Last& last = last_[index(channel)];
  counts_[index(channel)].num_duplicate += last.num_held_old;
  counts_[index(channel)].num_jumps += last.num_held() - last.num_held_old;
  if (!last.held.empty()) last.rival = last.held.back();
  last.held.clear();
  last.num_held_old = 0;
}

/// Each held message is used now, so that it is a duplicate when it comes again.
void SequenceGate::take_confirmed(Last& last) {
  for (const Stamp& stamp : last.held) remember(last, stamp);
  last.held.clear();
  last.num_held_old = 0;
}

void SequenceGate::take(Last& last, const Stamp& stamp) {
  if (last.seen) last.pace.note(last.stamp, stamp);
  last.seen = true;
  last.stamp = stamp;
  last.order = ++num_accepted_;
  remember(last, stamp);
}

void SequenceGate::remember(Last& last, const Stamp& stamp) {
  if (last.history.empty()) last.history.resize(kHistory);
  last.history[static_cast<std::size_t>(std::max(stamp.seq, 0) % kHistory)] = {stamp, last.run};
}

void SequenceGate::begin_again(Channel channel, const Stamp& stamp) {
  Last& last = last_[index(channel)];
  SequenceCounts& counts = counts_[index(channel)];
  if (last.seen) {
    ++counts.num_restarts;
    const std::int64_t change_us = stamp.utime - last.stamp.utime;
    if (change_us > kJump_us || change_us < -timing::DriveClock::kSetBack_us) {
      counts.clock_change_s = 1e-6 * static_cast<double>(change_us);
    }
    const bool soon = last.run > 1 && num_accepted_ - last.restart_order < kRestartsApart;
    if (soon && stamp.seq > 0 && stamp.seq < last.stamp.seq + kNearSeq)
      ++counts.num_second_source_signs;
    last.before = last.stamp;
    last.before_first_seq = last.first_seq;
    last.restart_order = num_accepted_;
  }
  ++last.run;
  last.first_seq = stamp.seq;
  take(last, stamp);
}

void SequenceGate::finish() {
  for (const ChannelInfo& channel : kChannels) drop_held(channel.channel);
}

SequenceCounts SequenceGate::counts() const {
  SequenceCounts sum;
  for (const SequenceCounts& counts : counts_) {
    sum.num_lost += counts.num_lost;
    sum.num_duplicate += counts.num_duplicate;
    sum.num_reordered += counts.num_reordered;
    sum.num_jumps += counts.num_jumps;
    sum.num_restarts += counts.num_restarts;
    sum.num_second_source_signs += counts.num_second_source_signs;
    if (std::abs(counts.clock_change_s) > std::abs(sum.clock_change_s)) {
      sum.clock_change_s = counts.clock_change_s;
    }
  }
  return sum;
}

}  // namespace orchard::bus
