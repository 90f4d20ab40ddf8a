// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

namespace orchard::mapping {

/// What one scan did to the map: ids of landmarks that are new or changed, and ids that are no
/// more because they were merged into another or stand there no longer. Both in rising order.
struct MapUpdate {
  std::vector<std::int32_t> changed_ids;
  std::vector<std::int32_t> removed_ids;
};

}  // namespace orchard::mapping
