// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

namespace orchard::mapping {

/// Changes of the map by one scan: ids of new or changed landmarks, and ids removed because they
/// were merged or no longer exist. Both in ascending order.
struct MapUpdate {
  std::vector<std::int32_t> changed_ids;
  std::vector<std::int32_t> removed_ids;
};

}  // namespace orchard::mapping
