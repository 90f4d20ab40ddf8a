// SPDX-License-Identifier: BSD-3-Clause
#include "pose/filter/displacement_histories.hpp"

#include <algorithm>
#include <cstddef>

namespace orchard::pose {
namespace {

/// Less likely histories are forgotten: one would move the mean path by less than a fiftieth of its
/// distance from it.
constexpr double kProbabilityMin = 0.02;

/// The path is solved once for each history.
constexpr std::size_t kHistoriesMax = 6;

}  // namespace

void DisplacementHistories::begin(std::int64_t utime, bool is_gnss) {
  for (DisplacementHistory& history : all_) history.displaced.push_back({utime, utime, is_gnss});
}

void DisplacementHistories::extend(std::int64_t utime) {
  for (DisplacementHistory& history : all_) history.displaced.back().end_utime = utime;
}

void DisplacementHistories::merge(const DisplacementHistories& other, double odds) {
  for (DisplacementHistory& history : all_) history.probability /= 1.0 + odds;
  for (const DisplacementHistory& history : other.all_) {
    const double probability = history.probability * odds / (1.0 + odds);
    const auto same = std::find_if(all_.begin(), all_.end(), [&](const DisplacementHistory& known) {
      return known.displaced == history.displaced;
    });
    if (same != all_.end()) {
      same->probability += probability;
    } else if (probability >= kProbabilityMin) {
      all_.push_back({probability, history.displaced});
    }
  }
  std::stable_sort(all_.begin(), all_.end(),
                   [](const DisplacementHistory& a, const DisplacementHistory& b) {
                     return a.probability > b.probability;
                   });
  while (all_.size() > 1 &&
         (all_.size() > kHistoriesMax || all_.back().probability < kProbabilityMin)) {
    all_.pop_back();
  }
  double sum = 0.0;
  for (const DisplacementHistory& history : all_) sum += history.probability;
  for (DisplacementHistory& history : all_) history.probability /= sum;
}

}  // namespace orchard::pose
