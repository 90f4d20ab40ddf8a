// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace orchard::mapping {

/// Which earlier index each landmark of a map that was derived anew keeps.
///
/// `then_of` gives, for each observation of a new landmark, the index of the landmark that it was
/// of before (-1: of none). Of all pairs of landmarks the one that shares most observations is
/// settled first, of equal ones that with the lower earlier index, then the lower new one; an index
/// is given once. A new landmark that is left without gets the next of those from `first_unused`
/// on, in order of its index; one without any observation -1. One entry per new index.
std::vector<std::int32_t> keep_indices(
    const std::function<std::vector<std::int32_t>(std::int32_t now)>& then_of, std::int32_t num_now,
    std::int32_t first_unused);

}  // namespace orchard::mapping
