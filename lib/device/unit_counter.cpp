// SPDX-License-Identifier: BSD-3-Clause
#include "device/unit_counter.hpp"

#include <utility>

namespace orchard::device {
namespace {

/// derived: STATUS counts an input's losses over as many.
constexpr std::int64_t kSeconds = 10;

/// derived: of a scanner at 10 Hz two sweeps in ten seconds, as a line has that is only noisy.
constexpr double kMaxRefused = 0.02;

}  // namespace

ProtocolCounts& UnitCounter::at(std::int64_t host_utime) {
  const std::int64_t number = host_utime / 1'000'000;
  if (seconds_.empty() || number > seconds_.back().number) seconds_.push_back({number, {}});
  while (seconds_.front().number <= seconds_.back().number - kSeconds) seconds_.pop_front();
  return seconds_.back().counts;
}

void UnitCounter::add_good(std::int64_t host_utime) {
  ++counts_.num_good;
  ++at(host_utime).num_good;
}

void UnitCounter::add_refused(std::int64_t host_utime, std::string why) {
  ++counts_.num_bad;
  ++at(host_utime).num_bad;
  why_ = std::move(why);
}

std::string UnitCounter::warning(std::string_view units) const {
  ProtocolCounts sum;
  for (const Second& second : seconds_) {
    sum.num_good += second.counts.num_good;
    sum.num_bad += second.counts.num_bad;
  }
  const std::int64_t num_all = sum.num_good + sum.num_bad;
  // One alone is no rate: half a unit at the start of a connection.
  if (sum.num_bad < 2 ||
      static_cast<double>(sum.num_bad) <= kMaxRefused * static_cast<double>(num_all))
    return {};
  return std::to_string(sum.num_bad) + " of " + std::to_string(num_all) + " " + std::string(units) +
         " refused in " + std::to_string(kSeconds) + " s: " + why_;
}

}  // namespace orchard::device
