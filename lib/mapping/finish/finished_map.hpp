// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "mapping/landmark.hpp"
#include "mapping/rows/navigation_graph.hpp"
#include "mapping/rows/rows.hpp"

namespace orchard::mapping {

/// Why a landmark of the mapper is not in the finished map.
enum class Omission {
  kFewObservations,  ///< fewer than mapper.min_observations
  kSpurious,         ///< never existed, judged by all scans
  kPart,             ///< of a long object, which is in the map
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

  std::size_t num_omitted(Omission reason) const;
};

}  // namespace orchard::mapping
