// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// Finds rows that are parts of hedges and no rows: most of their trees stand in the outline of a
/// long object, which was joined without them, and are no stems as sharp as those of the other rows
/// (stem_scatter.hpp). A laser takes parts of a hedge for trunks, and some of many stand in line.
///
/// `numbered`: the landmarks with the numbers of their rows. `joined`: the same after
/// join_long_objects(), trees of rows separate. Returns the ids of the trees of such rows in
/// ascending order; none if all rows are such, because then nothing tells how sharp a stem is.
std::vector<std::int32_t> trees_of_hedge_rows(const std::vector<Landmark>& numbered,
                                              const std::vector<Landmark>& joined);

}  // namespace orchard::mapping
