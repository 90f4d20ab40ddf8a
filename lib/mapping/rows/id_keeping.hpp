// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace orchard::mapping {

/// Assigns earlier indices to the landmarks of a rebuilt map. Returns one entry per new index.
///
/// `then_of(now)` returns, for each observation of new landmark `now`, the index of its earlier
/// landmark (-1: none). Pairs of earlier and new landmarks are assigned greedily by the number of
/// shared observations; ties go to the lower earlier index, then to the lower new one. Each index
/// is assigned once. Remaining new landmarks get indices from `first_unused` on, in order; those
/// without observations get -1.
std::vector<std::int32_t> keep_indices(
    const std::function<std::vector<std::int32_t>(std::int32_t now)>& then_of, std::int32_t num_now,
    std::int32_t first_unused);

}  // namespace orchard::mapping
