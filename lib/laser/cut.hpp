// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "laser/beams.hpp"

namespace orchard::laser {

/// Beams of one object; positions in Beams.
struct Run {
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
/// something thin in front is left out, as is what Run::fronts names.
template <class Visitor>
void for_each_beam(const Beams& beams, const Run& run, Visitor visit) {
  for (std::ptrdiff_t i = run.first; i <= run.last; ++i) {
    const float range_m = beams.range_m(i);
    if (range_m <= 0.0f || (run.num_fronts > 0 && run.in_front(i))) continue;
    const bool alone = i > run.first && i < run.last &&
                       !beams.joined(range_m, beams.range_m(i - 1)) &&
                       !beams.joined(range_m, beams.range_m(i + 1));
    if (!alone) visit(i);
  }
}

/// Cuts the beams at the spikes of their derivative (Shalal et al. 2013, figure 6).
std::vector<Run> cut(const Beams& beams);

/// Takes off a beam at the rim that is half on the object and half on what is behind or in front
/// of it.
void trim_rim(const Beams& beams, Run& run);

}  // namespace orchard::laser
