// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "mapping/landmark.hpp"
#include "text/finding.hpp"

namespace orchard::mapping {

/// Why a finished map is doubtful, found in the map itself: what contradicts physics or the purpose
/// of a map: more than one trunk in a hundred that stands in another, hardly a tree among many
/// landmarks, and no row among many trees (only if `has_rows`: rows were looked for). The worst
/// first; none for a map of fewer than thirty landmarks whose trunks stand apart. Their names:
/// overlapping_trees, few_trees, no_rows.
std::vector<Finding> findings_of(const std::vector<Landmark>& landmarks, bool has_rows);

}  // namespace orchard::mapping
