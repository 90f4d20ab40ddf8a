// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "mapping/landmark.hpp"
#include "mapping/mapper.hpp"
#include "mapping/rows/navigation_graph.hpp"
#include "mapping/rows/rows.hpp"
#include "pose/attitude/ground_profile.hpp"

namespace orchard::mapping {

/// Why a landmark of the mapper is not in the finished map.
enum class Omission {
  kFewObservations,  ///< fewer than mapper.min_observations
  kSpurious,         ///< never existed, judged by all scans
  kPart,             ///< of a plant or of a long object, which is in the map
};

struct OmittedLandmark {
  std::int32_t id = 0;
  Omission reason = Omission::kFewObservations;
};

/// The finished map of a drive: the only source of its files, pages, reports and last messages.
struct FinishedMap {
  std::vector<Landmark> landmarks;       ///< numbered, long objects joined, in order of id
  std::vector<Row> rows;                 ///< numbered_rows(landmarks), with their empty slots
  NavigationGraph graph;                 ///< aisles and headland paths on ground seen free
  std::vector<OmittedLandmark> omitted;  ///< in order of id
  /// Trees that were seen as foliage in an empty slot of their row, ascending: how wide their
  /// trunks are nobody knows.
  std::vector<std::int32_t> hidden_tree_ids;

  std::size_t num_omitted(Omission reason) const;
};

/// Finishes the map of a drive: leaves out landmarks with few observations and those that never
/// existed, joins long objects and the parts of plants, finds rows and numbers, and the ways
/// between them on ground that the scans saw free. A pure function of the mapper's state.
///
/// Trees of rows, stems as sharp as theirs, and trees by a camera stay separate landmarks; without
/// a camera, parts of a hedge may be classified as trunks, and the order of the rows tells how
/// probably a landmark is a tree (set_probability_by_order()) and which objects in gaps of the rows
/// are trees within foliage (name_trees_in_gaps()), whose width is 0, unknown. `heights`: of the
/// ground along the path, for those of the landmarks (set_heights()).
FinishedMap finish(const Mapper& mapper, const pose::GroundProfile& heights = {});

/// The same without ways, which take most of the time: for a table that is saved every second.
FinishedMap finish_without_ways(const Mapper& mapper, const pose::GroundProfile& heights = {});

/// The aisles and headland paths of a numbered map on ground that the mapper's scans saw free.
NavigationGraph navigation_graph_of(const std::vector<Landmark>& landmarks,
                                    const std::vector<Row>& rows, GroundOccupancy& ground);

/// Numbers a map that was made of several: rows are found, and trees with numbers keep them.
void number_merged(const RowsConfig& config, std::vector<Landmark>& landmarks);

}  // namespace orchard::mapping
