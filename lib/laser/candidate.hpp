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
  int num_beams = 0;  ///< number of beams on the object
  /// Foreground clutter that hides part of the object: positions of its first and last beam.
  struct Foreground {
    std::ptrdiff_t first = 0;
    std::ptrdiff_t last = -1;
  };
  static constexpr int kMaxForegrounds = 3;
  std::array<Foreground, kMaxForegrounds> foregrounds;
  int num_foregrounds = 0;
  bool is_bright = false;       ///< cut around a reflector
  bool touches_before = false;  ///< separated there from a touching object, not by a spike
  bool touches_after = false;
  bool hidden_before = false;  ///< continues there behind the touching object
  bool hidden_after = false;

  /// Whether position `i` lies in one of the fronts.
  bool in_foreground(std::ptrdiff_t i) const {
    for (int k = 0; k < num_foregrounds; ++k) {
      if (i >= foregrounds[k].first && i <= foregrounds[k].last) return true;
    }
    return false;
  }
};

/// Calls visit(position) for each beam on the object, in order. Skips beams without return, single
/// beams on a thin object in front, and the beams of Candidate::fronts.
template <class Visitor>
void for_each_beam(const Beams& beams, const Candidate& candidate, Visitor visit) {
  for (std::ptrdiff_t i = candidate.first; i <= candidate.last; ++i) {
    const float range_m = beams.range_m(i);
    if (range_m <= 0.0f || (candidate.num_foregrounds > 0 && candidate.in_foreground(i))) continue;
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
