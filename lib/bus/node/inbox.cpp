// SPDX-License-Identifier: BSD-3-Clause
#include "bus/node/inbox.hpp"

#include <algorithm>
#include <utility>

namespace orchard::bus {
namespace {

/// Larger gaps are not caused by reordering in the network.
constexpr std::int64_t kGapMax = 64;
constexpr std::size_t kParkedMax = 128;

}  // namespace

void Inbox::add(Arrival arrival) {
  Lane& lane = lane_of(arrival.message);
  const bool is_image = channel_of(arrival.message) == Channel::kImage;
  if (is_image && lane.num_ready >= kImagesMax) drop_oldest_image();
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
  ready_.push_back(std::move(arrival));
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
  if (ready_.empty()) return std::nullopt;
  Arrival arrival = std::move(ready_.front());
  ready_.pop_front();
  forget(lane_of(arrival.message), arrival);
  return arrival;
}

std::optional<int> Inbox::ms_until_next(Clock::time_point now) const {
  if (!ready_.empty()) return 0;
  if (num_parked_ == 0) return std::nullopt;
  std::int64_t ms = kReorderWait.count();
  for (const Lane& lane : lanes_) {
    if (lane.parked.empty()) continue;
    const auto left = lane.parked.front().time + kReorderWait - now;
    ms = std::min(ms, std::chrono::ceil<std::chrono::milliseconds>(left).count());
  }
  return static_cast<int>(std::max<std::int64_t>(ms, 0));
}

void Inbox::drop_oldest_image() {
  const auto oldest = std::find_if(ready_.begin(), ready_.end(), [](const Arrival& waiting) {
    return channel_of(waiting.message) == Channel::kImage;
  });
  if (oldest == ready_.end()) return;
  forget(lane_of(oldest->message), *oldest);
  ready_.erase(oldest);
}

void Inbox::forget(Lane& lane, const Arrival& arrival) {
  --lane.num_ready;
  num_bytes_ -= arrival.num_bytes;
}

}  // namespace orchard::bus
