// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "mapping/finish/finished_map.hpp"
#include "mapping/mapper.hpp"
#include "mapping/rows/rows_config.hpp"

namespace orchard::mapping {

struct FinishConfig {
  int min_observations = 1;
  RowsConfig rows;
  bool has_camera = false;
  double object_width_max_m = 1.0;  ///< max object width reported by the detector
};

/// Finishes the map of a drive: leaves out landmarks with few observations and those that never
/// existed, joins long objects, finds rows and numbers, and the ways between them on ground that
/// the scans saw free. A pure function of the mapper's state.
///
/// Trees of rows, stems as sharp as theirs, and trees by a camera stay separate landmarks; without
/// a camera, parts of a hedge may be classified as trunks.
FinishedMap finish(const Mapper& mapper, const FinishConfig& config);

/// The same without ways, which take most of the time: for a table that is saved every second.
FinishedMap finish_without_ways(const Mapper& mapper, const FinishConfig& config);

/// The aisles and headland paths of a numbered map on ground that the mapper's scans saw free.
NavigationGraph navigation_graph_of(const std::vector<Landmark>& landmarks,
                                    const std::vector<Row>& rows, GroundOccupancy& ground);

/// Numbers a map that was made of several: rows are found, and trees with numbers keep them.
void number_merged(const RowsConfig& config, std::vector<Landmark>& landmarks);

}  // namespace orchard::mapping
