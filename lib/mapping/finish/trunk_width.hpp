// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// The width of the trunks of a map, as its landmarks show it.
struct TrunkWidth {
  double mean_m = 0.0;
  double sd_m = 0.0;  ///< of one trunk
  double mean_se_m = 0.0;
  int num_trunks = 0;
};

/// Finds the width that most round landmarks have, within a factor of two to either side:
/// trunks of one planting are alike, and bushes, posts and twigs are not. Where there are
/// rows, what stands in them counts alone. Landmarks seen less than five times do not count. None
/// for fewer than eight, or if no width is more frequent than it would be among widths of any size.
std::optional<TrunkWidth> trunk_width_of(const std::vector<Landmark>& landmarks);

}  // namespace orchard::mapping
