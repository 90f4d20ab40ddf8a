// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "laser/splitting/candidate_fit.hpp"

namespace orchard::laser {

constexpr int kMinPartBeams = 3;

/// The part of a candidate from one beam to another, both on it.
Candidate part_of(const Beams& beams, const Candidate& candidate, std::ptrdiff_t first,
                  std::ptrdiff_t last);

struct Split {
  Candidate before, after;
};

/// Cuts after the beam at a position, which is on the candidate and not its last.
Split split_at(const Beams& beams, const Candidate& candidate, std::ptrdiff_t position);

/// Marks, of two touching parts at different depth, the farther one's shared side as hidden: it
/// continues behind the nearer one.
void order_by_depth(Candidate& before, Candidate& after, CandidateFitter& fit);

}  // namespace orchard::laser
