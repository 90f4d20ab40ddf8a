// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "laser/beams.hpp"

namespace orchard::laser {

/// A segment candidate: the beams of one object, as positions in Beams.
struct Candidate {
  std::ptrdiff_t first = 0;
  std::ptrdiff_t last = 0;
  int num_beams = 0;            ///< number of beams on the object
  bool is_bright = false;       ///< cut around a reflector
  bool touches_before = false;  ///< separated there from a touching object, not by a spike
  bool touches_after = false;
  bool hidden_before = false;  ///< continues there behind the touching object
  bool hidden_after = false;
};

/// Calls visit(position) for each beam on the object, in order. Skips beams without return and
/// single beams on a thin object in front.
template <class Visitor>
void for_each_beam(const Beams& beams, const Candidate& candidate, Visitor visit) {
  for (std::ptrdiff_t i = candidate.first; i <= candidate.last; ++i) {
    const float range_m = beams.range_m(i);
    if (range_m <= 0.0f) continue;
    const bool alone = i > candidate.first && i < candidate.last &&
                       !beams.joined(range_m, beams.range_m(i - 1)) &&
                       !beams.joined(range_m, beams.range_m(i + 1));
    if (!alone) visit(i);
  }
}

/// Cuts the beams at the spikes of their derivative (Shalal et al. 2013, figure 6).
std::vector<Candidate> find_candidates(const Beams& beams);

/// Removes a border beam whose footprint covers the object and a surface behind or in front of it
/// (mixed pixel).
void trim_border(const Beams& beams, Candidate& candidate);

}  // namespace orchard::laser
