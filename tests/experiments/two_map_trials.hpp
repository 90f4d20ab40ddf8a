// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

/// Each runs its trials for every seed of [first, last], prints what came of them, and returns
/// whether all that is asked for was reached.
namespace orchard::trials {

struct Seeds {
  std::uint64_t first = 1, last = 1;
};

/// What compare finds of what changed between two drives, and how honest its confidences are.
bool run_changes(const Seeds& seeds);
/// Ids and numbers after the block was mapped again.
bool run_ids(const Seeds& seeds);
/// Three robots' partial maps as one.
bool run_merge(const Seeds& seeds);

}  // namespace orchard::trials
