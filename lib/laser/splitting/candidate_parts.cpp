// SPDX-License-Identifier: BSD-3-Clause
#include "laser/splitting/candidate_parts.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::laser {
namespace {

/// Difference in distance, in radii, from which one part is behind the other, not beside it.
constexpr double kBehind = 0.75;

}  // namespace

Candidate part_of(const Beams& beams, const Candidate& candidate, std::ptrdiff_t first,
                  std::ptrdiff_t last) {
  Candidate part = candidate;
  part.first = first;
  part.last = last;
  if (first > candidate.first) part.touches_before = true, part.hidden_before = false;
  if (last < candidate.last) part.touches_after = true, part.hidden_after = false;
  part.num_beams = 0;
  for_each_beam(beams, part, [&](std::ptrdiff_t) { ++part.num_beams; });
  return part;
}

Split split_at(const Beams& beams, const Candidate& candidate, std::ptrdiff_t position) {
  std::ptrdiff_t next = candidate.last;
  for_each_beam(beams, candidate, [&](std::ptrdiff_t i) {
    if (i > position) next = std::min(next, i);
  });
  return {part_of(beams, candidate, candidate.first, position),
          part_of(beams, candidate, next, candidate.last)};
}

void order_by_depth(Candidate& before, Candidate& after, CandidateFitter& fit) {
  const auto first = fit(before), second = fit(after);
  if (!first || !second) return;
  // The circles are in different frames (each relative to its first beam): only distances compare.
  const double behind_m = std::hypot(second->x_m, second->y_m) - std::hypot(first->x_m, first->y_m);
  if (std::abs(behind_m) < kBehind * std::min(first->radius_m, second->radius_m)) return;
  const bool first_is_nearer = behind_m > 0.0;
  (first_is_nearer ? before.touches_after : after.touches_before) = false;
  (first_is_nearer ? after.hidden_before : before.hidden_after) = true;
}

}  // namespace orchard::laser
