// SPDX-License-Identifier: BSD-3-Clause
#include "laser/splitting/run_parts.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::laser {
namespace {

/// Axes so much farther away, in radii, are behind and not beside.
constexpr double kBehind = 0.75;

}  // namespace

Run part_of(const Beams& beams, const Run& run, std::ptrdiff_t first, std::ptrdiff_t last) {
  Run part = run;
  part.first = first;
  part.last = last;
  part.num_fronts = 0;
  for (int k = 0; k < run.num_fronts; ++k) {
    const Run::Front& front = run.fronts[k];
    if (front.first > first && front.last < last) part.fronts[part.num_fronts++] = front;
  }
  if (first > run.first) part.touches_before = true, part.hidden_before = false;
  if (last < run.last) part.touches_after = true, part.hidden_after = false;
  part.num_beams = 0;
  for_each_beam(beams, part, [&](std::ptrdiff_t) { ++part.num_beams; });
  return part;
}

Parting part_at(const Beams& beams, const Run& run, std::ptrdiff_t position) {
  std::ptrdiff_t next = run.last;
  for_each_beam(beams, run, [&](std::ptrdiff_t i) {
    if (i > position) next = std::min(next, i);
  });
  return {part_of(beams, run, run.first, position), part_of(beams, run, next, run.last)};
}

void order_by_depth(Run& before, Run& after, RunFitter& fit) {
  const auto first = fit(before), second = fit(after);
  if (!first || !second) return;
  // both circles are given from their own first beam: distances compare, places do not
  const double behind_m = std::hypot(second->x_m, second->y_m) - std::hypot(first->x_m, first->y_m);
  if (std::abs(behind_m) < kBehind * std::min(first->radius_m, second->radius_m)) return;
  const bool first_is_nearer = behind_m > 0.0;
  (first_is_nearer ? before.touches_after : after.touches_before) = false;
  (first_is_nearer ? after.hidden_before : before.hidden_after) = true;
}

}  // namespace orchard::laser
