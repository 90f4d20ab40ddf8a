// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "laser/splitting/run_fit.hpp"

namespace orchard::laser {

constexpr int kFewestBeamsOfAPart = 3;

/// The part of a run from one beam to another, both on it.
Run part_of(const Beams& beams, const Run& run, std::ptrdiff_t first, std::ptrdiff_t last);

struct Parting {
  Run before, after;
};

/// Cuts after the beam at a position, which is on the run and not its last.
Parting part_at(const Beams& beams, const Run& run, std::ptrdiff_t position);

/// Of two that touch and do not stand side by side the nearer one's side shows, and the other goes
/// on behind it.
void order_by_depth(Run& before, Run& after, RunFitter& fit);

}  // namespace orchard::laser
