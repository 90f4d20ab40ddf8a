// SPDX-License-Identifier: BSD-3-Clause
#include "bus/node/live_inputs.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "text/number_text.hpp"

namespace orchard::bus {
namespace {

/// Larger gaps are not caused by reordering in the network.
constexpr std::int64_t kGapMax = 64;
constexpr std::size_t kParkedMax = 128;

using Seconds = std::chrono::duration<double>;

/// A channel is stale after this many of its usual periods, but not before half a second: a busy
/// machine may delay several scans at 10 Hz.
constexpr double kPeriodsSilent = 3.0;
constexpr Seconds kSilentMin{0.5};

/// Min number of gaps to estimate a period.
constexpr std::size_t kGapsMin = 2;

constexpr std::size_t kSecondsCounted = 10;

std::string fraction(const char* what, std::int64_t num, std::int64_t num_all) {
  if (num <= 0) return {};
  const double percent =
      100.0 * static_cast<double>(num) / static_cast<double>(std::max(num, num_all));
  return ", " + fixed_text(percent, 1) + " % " + what;
}

}  // namespace

void Inbox::add(Arrival arrival) {
  Lane& lane = lane_of(arrival.message);
  const bool is_image = channel_of(arrival.message) == Channel::kImage;
  if (is_image && needs_images_) drop_images_before(arrival.time - kImageWait);
  if (lane.num_ready + lane.parked.size() >= kMessagesMax ||
      num_bytes_ + arrival.num_bytes > kBytesMax) {
    ++num_dropped_;
    return;
  }
  num_bytes_ += arrival.num_bytes;
  const std::int32_t seq = seq_of(arrival.message);
  const std::int64_t gap = lane.last_seq ? std::int64_t{seq} - *lane.last_seq : 1;
  if (gap < 2 || gap > kGapMax || lane.parked.size() >= kParkedMax) {
    pass(lane, std::move(arrival));
  } else {
    const auto after = std::upper_bound(
        lane.parked.begin(), lane.parked.end(), seq,
        [](std::int32_t s, const Arrival& other) { return s < seq_of(other.message); });
    lane.parked.insert(after, std::move(arrival));
    ++num_parked_;
  }
  release(lane, Clock::time_point::min());
}

void Inbox::pass(Lane& lane, Arrival arrival) {
  const std::int32_t seq = seq_of(arrival.message);
  // A duplicate or an old message keeps last_seq; a restarted source resets it.
  if (!lane.last_seq || seq > *lane.last_seq || *lane.last_seq - seq > kGapMax) {
    lane.last_seq = seq;
  }
  ++lane.num_ready;
  lane.passed_time = arrival.time = std::max(arrival.time, lane.passed_time);
  const auto after = std::upper_bound(
      ready_.begin(), ready_.end(), arrival.time,
      [](Clock::time_point time, const Arrival& other) { return time < other.time; });
  ready_.insert(after, std::move(arrival));
}

/// Whether there is none to be taken: what arrived after a message that waits for its predecessor
/// waits, too, or other channels would overtake it where one of its own was lost.
bool Inbox::is_held() const {
  if (ready_.empty()) return true;
  const auto is_before = [this](const Arrival& parked) {
    return parked.time < ready_.front().time;
  };
  return num_parked_ > 0 &&
         std::any_of(lanes_.begin(), lanes_.end(), [&is_before](const Lane& lane) {
           return std::any_of(lane.parked.begin(), lane.parked.end(), is_before);
         });
}

/// Passes on the messages that follow without a gap, and those that arrived before the given time.
void Inbox::release(Lane& lane, Clock::time_point arrived_before) {
  std::size_t num = 0;
  for (Arrival& first : lane.parked) {
    const bool follows = std::int64_t{seq_of(first.message)} - *lane.last_seq < 2;
    if (!follows && first.time > arrived_before) break;
    pass(lane, std::move(first));
    ++num;
  }
  lane.parked.erase(lane.parked.begin(), lane.parked.begin() + static_cast<std::ptrdiff_t>(num));
  num_parked_ -= num;
}

void Inbox::release_all() {
  for (Lane& lane : lanes_) {
    if (!lane.parked.empty()) release(lane, Clock::time_point::max());
  }
}

std::optional<Inbox::Arrival> Inbox::take(Clock::time_point now) {
  if (num_parked_ > 0) {
    for (Lane& lane : lanes_) {
      if (!lane.parked.empty()) release(lane, now - kReorderWait);
    }
  }
  if (is_held()) return std::nullopt;
  Arrival arrival = std::move(ready_.front());
  ready_.pop_front();
  forget(lane_of(arrival.message), arrival);
  return arrival;
}

std::optional<int> Inbox::ms_until_next(Clock::time_point now) const {
  if (!is_held()) return 0;
  if (num_parked_ == 0) return std::nullopt;
  std::int64_t ms = kReorderWait.count();
  for (const Lane& lane : lanes_) {
    if (lane.parked.empty()) continue;
    const auto left = lane.parked.front().time + kReorderWait - now;
    ms = std::min(ms, std::chrono::ceil<std::chrono::milliseconds>(left).count());
  }
  return static_cast<int>(std::max<std::int64_t>(ms, 0));
}

void Inbox::drop_images_before(Clock::time_point time) {
  Lane& images = lanes_[static_cast<std::size_t>(Channel::kImage)];
  const auto is_dropped = [&](const Arrival& waiting) {
    const bool is_old = waiting.time < time && channel_of(waiting.message) == Channel::kImage;
    if (is_old) forget(images, waiting);
    return is_old;
  };
  if (images.num_ready == 0 || ready_.front().time >= time) return;
  ready_.erase(std::remove_if(ready_.begin(), ready_.end(), is_dropped), ready_.end());
}

void Inbox::forget(Lane& lane, const Arrival& arrival) {
  --lane.num_ready;
  num_bytes_ -= arrival.num_bytes;
}

void InputWatch::note(Channel channel, Clock::time_point now) {
  Input& input = inputs_[static_cast<std::size_t>(channel)];
  if (input.last) input.gaps[input.num_gaps++ % input.gaps.size()] = now - *input.last;
  input.last = now;
  input.stale_from = stale_from(input);
}

/// The median, so that one long silence does not become the expected period.
std::optional<Seconds> InputWatch::period(const Input& input) {
  if (input.num_gaps < kGapsMin) return std::nullopt;
  auto gaps = input.gaps;
  const std::size_t num = std::min(input.num_gaps, gaps.size());
  const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(num / 2);
  std::nth_element(gaps.begin(), middle, gaps.begin() + static_cast<std::ptrdiff_t>(num));
  return *middle;
}

std::optional<InputWatch::Clock::time_point> InputWatch::stale_from(const Input& input) {
  const std::optional<Seconds> usual = period(input);
  if (!usual) return std::nullopt;
  const Seconds silence = std::max(kSilentMin, kPeriodsSilent * *usual);
  return *input.last + std::chrono::duration_cast<Clock::duration>(silence);
}

bool InputWatch::update(Clock::time_point now) {
  bool changed = false;
  for (Input& input : inputs_) {
    const bool stale = input.stale_from && now >= *input.stale_from;
    changed = changed || stale != input.stale;
    input.stale = stale;
  }
  return changed;
}

int InputWatch::ms_until_change(Clock::time_point now) const {
  std::int64_t ms = 1000;
  for (const Input& input : inputs_) {
    if (!input.stale_from || input.stale) continue;
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(*input.stale_from - now);
    ms = std::min(ms, left.count());
  }
  return static_cast<int>(std::max<std::int64_t>(ms, 0));
}

void InputWatch::count(Channel channel, const SequenceCounts& counts, std::int64_t num_used) {
  std::deque<Totals>& seconds = inputs_[static_cast<std::size_t>(channel)].seconds;
  seconds.push_back({counts, num_used});
  if (seconds.size() > kSecondsCounted + 1) seconds.pop_front();
}

SequenceCounts InputWatch::recent_counts(const Input& input) {
  if (input.seconds.size() < 2) return {};
  const SequenceCounts& then = input.seconds.front().counts;
  SequenceCounts counts = input.seconds.back().counts;
  counts.num_lost -= then.num_lost;
  counts.num_duplicate -= then.num_duplicate;
  counts.num_reordered -= then.num_reordered;
  counts.num_jumps -= then.num_jumps;
  counts.num_restarts -= then.num_restarts;
  counts.num_second_source_signs -= then.num_second_source_signs;
  return counts;
}

bool InputWatch::is_serious(Channel channel) const {
  const SequenceCounts counts = recent_counts(at(channel));
  return at(channel).stale || counts.num_lost > 0 || counts.num_jumps > 0 ||
         has_two_sources(channel);
}

bool InputWatch::has_two_sources(Channel channel) const {
  return recent_counts(at(channel)).num_second_source_signs > 2;
}

std::string InputWatch::text(Channel channel, Clock::time_point now) const {
  const Input& input = at(channel);
  const std::string name(info(channel).name);
  const SequenceCounts counts = recent_counts(input);
  const std::int64_t num_used =
      input.seconds.size() > 1 ? input.seconds.back().num_used - input.seconds.front().num_used : 0;
  const std::int64_t num_sent = num_used + counts.num_lost;
  std::string fractions = fraction("lost", counts.num_lost, num_sent) +
                          fraction("late", counts.num_reordered, num_sent) +
                          fraction("duplicate", counts.num_duplicate, num_sent);
  if (counts.num_jumps > 0) {
    fractions += ", " + std::to_string(counts.num_jumps) + " refused for a jump in time or seq";
  }
  if (counts.num_second_source_signs > 2) fractions += ", from two sources";
  if (counts.num_restarts > 0) {
    fractions += ", its sender was restarted";
    if (counts.clock_change_s != 0.0) {
      fractions += " and its clock was changed by " + fixed_text(counts.clock_change_s, 1) + " s";
    }
  }
  if (input.stale) {
    return name + " is STALE: silent for " + fixed_text(Seconds(now - *input.last).count(), 1) +
           " s (usual period " + fixed_text(period(input)->count(), 2) + " s)" + fractions;
  }
  return fractions.empty() ? "" : name + " in the last 10 s: " + fractions.substr(2);
}

}  // namespace orchard::bus
