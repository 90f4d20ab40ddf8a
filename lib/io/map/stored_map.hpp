// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "geometry/georeference.hpp"
#include "mapping/compare/visibility.hpp"
#include "mapping/landmark.hpp"
#include "mapping/rows/navigation_graph.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::io {

/// A map read from its files.
struct StoredMap {
  std::string name;  ///< path of its map.csv, for messages
  std::vector<mapping::Landmark> landmarks;
  std::vector<std::vector<pose::PoseEstimate>> trajectories;  ///< one per drive; empty: unknown
  mapping::SensorView view;  ///< default values if the folder has none
  std::optional<geometry::Georeference> georeference;
  mapping::NavigationGraph graph;  ///< of graph.json; empty if there is none
  std::int32_t next_id = 1;        ///< above every id of this and earlier maps
};

/// Reads a map folder, or only its map.csv (then path, view and graph are unknown).
///
/// Throws FileError naming file, line and column of the first error; also for a map without
/// landmarks, and for one whose coordinates cannot be metres (millimetres, degrees).
StoredMap read_stored_map(const std::string& folder_or_csv);

}  // namespace orchard::io
