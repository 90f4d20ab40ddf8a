// SPDX-License-Identifier: BSD-3-Clause
#include "bus/replay/arrival_delays.hpp"

#include <algorithm>
#include <utility>

#include "text/number_text.hpp"

namespace orchard::bus {
namespace {

constexpr std::size_t kSamplesMax = 4096;
constexpr std::size_t kSamplesMin = 20;

/// Max interquartile range of a channel's delays. A larger one means that the log was not recorded
/// in real time: it was played faster, or its times are artificial.
constexpr std::int64_t kSteady_us = 100'000;

/// No message is recorded before its measurement; clocks synchronized over a network agree to this.
constexpr std::int64_t kBefore_us = 50'000;

/// Larger than the delays of a sweep, an exposure, compression and a wireless network together.
constexpr std::int64_t kApart_us = 300'000;

/// Channels that publish without delay; GNSS and POSE_FIX do not.
constexpr std::array<Channel, 5> kPrompt = {Channel::kScan, Channel::kScanRear, Channel::kImage,
                                            Channel::kOdometry, Channel::kImu};

std::int64_t quantile(std::vector<std::int64_t> values, double fraction) {
  const auto at = values.begin() +
                  static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

std::string seconds_text(std::int64_t us) { return fixed_text(1e-6 * static_cast<double>(us), 2); }

struct Delay {
  Channel channel;
  std::int64_t median_us;
};

std::string names_of(const std::vector<Delay>& delays) {
  std::string text;
  for (const Delay& delay : delays) {
    text += (text.empty() ? "" : ", ") + std::string(info(delay.channel).name);
  }
  return text;
}

}  // namespace

void ArrivalDelays::add(Channel channel, std::int64_t utime, std::int64_t recorded_utime) {
  if (std::find(kPrompt.begin(), kPrompt.end(), channel) == kPrompt.end()) return;
  Sample& sample = samples_[static_cast<std::size_t>(channel)];
  if (sample.num++ % sample.every != 0) return;
  sample.delays_us.push_back(recorded_utime - utime);
  if (sample.delays_us.size() < kSamplesMax) return;
  sample.every *= 2;
  for (std::size_t i = 1; 2 * i < sample.delays_us.size(); ++i) {
    sample.delays_us[i] = sample.delays_us[2 * i];
  }
  sample.delays_us.resize(sample.delays_us.size() / 2);
}

std::vector<std::string> ArrivalDelays::warnings() const {
  std::vector<Delay> delays;
  for (const Channel channel : kPrompt) {
    const std::vector<std::int64_t>& all = samples_[static_cast<std::size_t>(channel)].delays_us;
    if (all.size() < kSamplesMin) continue;
    if (quantile(all, 0.75) - quantile(all, 0.25) > kSteady_us) continue;
    delays.push_back({channel, quantile(all, 0.5)});
  }
  if (delays.size() < 2) return {};
  std::stable_sort(delays.begin(), delays.end(),
                   [](const Delay& a, const Delay& b) { return a.median_us < b.median_us; });
  const std::int64_t least_us = delays.front().median_us, most_us = delays.back().median_us;
  const bool some_are_ahead = least_us < -kBefore_us && most_us >= -kBefore_us;
  if (!some_are_ahead && most_us - least_us <= kApart_us) return {};
  const std::int64_t limit_us = some_are_ahead ? -kBefore_us : least_us + kApart_us;
  const auto split = std::partition_point(delays.begin(), delays.end(),
                                          [&](const Delay& d) { return d.median_us < limit_us; });
  const std::vector<Delay> early(delays.begin(), split), late(split, delays.end());
  const std::string by = seconds_text(most_us - least_us) + " s";
  if (some_are_ahead) {
    return {"the clock of the sender of " + names_of(early) + " is " + by + " ahead of that of " +
            names_of(late) +
            ": messages were logged before their own time stamp. Positions are wrong by the "
            "distance driven in that time; synchronise the clocks"};
  }
  return {names_of(late) + " was logged " + by + " later after its time stamp than " +
          names_of(early) + ": the clock of its sender is behind, or it was delayed"};
}

}  // namespace orchard::bus
