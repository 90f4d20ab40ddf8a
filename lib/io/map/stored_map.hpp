// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "geometry/georeference.hpp"
#include "mapping/compare/visibility_grid.hpp"
#include "mapping/landmark.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::io {

/// A map as it was read back from its files.
struct StoredMap {
  std::string name;  ///< of its map.csv, for messages
  std::vector<mapping::Landmark> landmarks;
  std::vector<std::vector<pose::PoseEstimate>> trajectories;  ///< of each drive; none: not known
  mapping::SensorView view;  ///< the usual one where the folder does not tell
  std::optional<geometry::Georeference> georeference;
  std::int32_t next_id = 1;  ///< no landmark of it or of an earlier map had this or more
};

/// Reads a map folder, or its map.csv alone (then neither path nor view are known).
///
/// Throws FileError naming file, line and column of the first mistake; also for a map without
/// landmarks, and for one whose numbers are no metres (millimetres, degrees).
StoredMap read_stored_map(const std::string& folder_or_csv);

}  // namespace orchard::io
