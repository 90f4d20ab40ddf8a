// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/compare/alignment_hypothesis.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/statistics.hpp"

namespace orchard::mapping {

double agreement(const AlignmentHypothesis& h, double null_place_m2, double null_width_m2) {
  constexpr double kNullPoints = 5.0;
  const double n = h.num_agreeing;
  const auto gain = [n](double own, double null) {
    return 0.5 * n * std::log(null * (n + kNullPoints) / (n * own + kNullPoints * null));
  };
  return 2.0 * gain(h.place_m2(), null_place_m2) + gain(h.width_m2(), null_width_m2);
}

MostPromising::MostPromising(const std::vector<AlignmentHypothesis>& hypotheses)
    : is_taken_(hypotheses.size(), false) {
  std::vector<double> places_m2, widths_m2;
  for (const AlignmentHypothesis& h : hypotheses) {
    places_m2.push_back(h.place_m2());
    widths_m2.push_back(h.width_m2());
  }
  const double place_m2 = std::max(1e-6, geometry::median(std::move(places_m2)));
  const double width_m2 = std::max(1e-6, geometry::median(std::move(widths_m2)));
  std::vector<Rank> by_agreement, by_number;
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    const AlignmentHypothesis& h = hypotheses[i];
    by_agreement.push_back({agreement(h, place_m2, width_m2), 0.0, i});
    by_number.push_back({static_cast<double>(h.num_agreeing), -h.sum_m2, i});
  }
  queues_[0] = Queue({}, std::move(by_agreement));
  queues_[1] = Queue({}, std::move(by_number));
}

std::optional<std::size_t> MostPromising::next() {
  while (!queues_[turn_].empty()) {
    const std::size_t i = queues_[turn_].top().index;
    queues_[turn_].pop();
    turn_ = 1 - turn_;
    if (is_taken_[i]) continue;
    is_taken_[i] = true;
    return i;
  }
  return std::nullopt;
}

}  // namespace orchard::mapping
