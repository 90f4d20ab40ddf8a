// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// Why a finished map is doubtful, found in the map itself.
struct Doubt {
  std::string name;  ///< for programs: overlapping_trees, few_trees, no_rows
  std::string text;  ///< for people: what is wrong, and what to do
};

/// What contradicts physics or the purpose of a map: more than one trunk in a hundred that stands
/// in another, hardly a tree among many landmarks, and no row among many trees (only if `has_rows`:
/// rows were looked for). The worst first; none for a map of fewer than thirty landmarks whose
/// trunks stand apart.
std::vector<Doubt> doubts_of(const std::vector<Landmark>& landmarks, bool has_rows);

}  // namespace orchard::mapping
