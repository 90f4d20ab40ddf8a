// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "laser/splitting/candidate_fit.hpp"

namespace orchard::laser {

/// Min number of beams of a part with a circle.
constexpr int kMinPartBeams = 3;

/// The part of a candidate from beam `first` to beam `last`, both on the object.
Candidate part_of(const Beams& beams, const Candidate& candidate, std::ptrdiff_t first,
                  std::ptrdiff_t last);

struct Split {
  Candidate before, after;
};

/// Splits a candidate after the beam at `position`, which lies on the object and is not its last.
Split split_at(const Beams& beams, const Candidate& candidate, std::ptrdiff_t position);

/// For two touching parts at different depths, marks the common side of the farther part as hidden,
/// because it continues behind the nearer one.
void order_by_depth(Candidate& before, Candidate& after, CandidateFitter& fit);

}  // namespace orchard::laser
