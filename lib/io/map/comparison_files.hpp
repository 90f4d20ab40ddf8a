// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/georeference.hpp"
#include "io/figure/map_figure.hpp"
#include "mapping/compare/map_comparison.hpp"

namespace orchard::io {

/// What was compared, and what came of it. References: all outlive it.
struct ComparisonContent {
  std::string name_a;  ///< of the earlier map, as the user gave it
  std::string name_b;
  const std::vector<mapping::Landmark>& a;
  const std::vector<mapping::Landmark>& b;
  const mapping::MapAlignment& alignment;
  const mapping::MapComparison& comparison;
  std::optional<geometry::Georeference> georeference;  ///< of the earlier map
};

/// compare.csv as text: change,confidence,id_a,id_b,class_a,class_b,x_m,y_m,moved_m,width_a_m,
/// width_b_m,width_change_m,width_change_se_m,row,position. Places in the frame of the earlier map.
std::string comparison_csv(const ComparisonContent& content);

/// The same with the alignment and the counts, for programs; lengths in metres.
std::string comparison_json(const ComparisonContent& content);

/// Where what changed: missing red and crossed out, new green, moved blue with a line from the old
/// place, grown and thinner violet with a ring, unchanged and not seen grey; with ids, ways and
/// widths.
MapFigure draw_comparison(const ComparisonContent& content);

/// Writes compare.csv, compare.gpkg (a layer `changes` of points), compare.svg, compare.png and
/// compare.json into `folder` (made when missing), all or none. Throws FileError.
void write_comparison_folder(const std::string& folder, const ComparisonContent& content);

}  // namespace orchard::io
