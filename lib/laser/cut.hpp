// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "laser/beams.hpp"

namespace orchard::laser {

/// A segment candidate: the beams of one object, as positions in Beams.
struct Candidate {
  std::ptrdiff_t first = 0;
  std::ptrdiff_t last = 0;
  int num_beams = 0;  ///< that lie on the object
  /// Where the object goes on behind something thin: positions of the first and last beam in front.
  struct Front {
    std::ptrdiff_t first = 0;
    std::ptrdiff_t last = -1;
  };
  static constexpr int kMaxFronts = 3;
  std::array<Front, kMaxFronts> fronts;
  int num_fronts = 0;
  bool is_bright = false;       ///< cut around a reflector
  bool touches_before = false;  ///< cut from what touches it there, not by a spike
  bool touches_after = false;
  bool hidden_before = false;  ///< goes on there behind what touches it
  bool hidden_after = false;

  bool in_front(std::ptrdiff_t i) const {
    for (int k = 0; k < num_fronts; ++k) {
      if (i >= fronts[k].first && i <= fronts[k].last) return true;
    }
    return false;
  }
};

/// Calls visit(position) for each beam on the object, in order. A single beam that is missing or on
/// something thin in front is left out, as is what Candidate::fronts names.
template <class Visitor>
void for_each_beam(const Beams& beams, const Candidate& candidate, Visitor visit) {
  for (std::ptrdiff_t i = candidate.first; i <= candidate.last; ++i) {
    const float range_m = beams.range_m(i);
    if (range_m <= 0.0f || (candidate.num_fronts > 0 && candidate.in_front(i))) continue;
    const bool alone = i > candidate.first && i < candidate.last &&
                       !beams.joined(range_m, beams.range_m(i - 1)) &&
                       !beams.joined(range_m, beams.range_m(i + 1));
    if (!alone) visit(i);
  }
}

/// Cuts the beams at the spikes of their derivative (Shalal et al. 2013, figure 6).
std::vector<Candidate> cut(const Beams& beams);

/// Removes a border beam whose footprint covers the object and a surface behind or in front of it
/// (mixed pixel).
void trim_border(const Beams& beams, Candidate& candidate);

}  // namespace orchard::laser
