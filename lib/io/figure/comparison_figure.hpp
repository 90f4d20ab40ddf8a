// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/georeference.hpp"
#include "io/figure/canvas.hpp"
#include "mapping/compare/map_comparison.hpp"

namespace orchard::io {

/// Two compared maps and the result of the comparison. All references must outlive it.
struct ComparisonContent {
  std::string name_a;  ///< earlier map, as the user named it
  std::string name_b;
  const std::vector<mapping::Landmark>& a;
  const std::vector<mapping::Landmark>& b;
  const mapping::MapAlignment& alignment;
  const mapping::MapComparison& comparison;
  std::optional<geometry::Georeference> georeference;  ///< of the earlier map
};

/// Draws the changes: missing red and crossed out, new green, moved blue with a line from the old
/// position, grown and thinner violet with a ring, unchanged and not seen grey; with ids, distances
/// and widths. Returns the file.
std::string comparison_figure(const ComparisonContent& content, FigureFormat format);

}  // namespace orchard::io
