// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "geometry/georeference.hpp"
#include "io/map/map_csv.hpp"
#include "mapping/album/photograph.hpp"
#include "mapping/compare/visibility_grid.hpp"
#include "mapping/landmark.hpp"
#include "mapping/rows/free_corridor.hpp"
#include "mapping/rows/rows.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::io {

/// What summary.json says besides the map: how it was made and what was lost on the way.
struct MapSummary {
  std::string source;  ///< log file name (no folder), or "live"
  std::int64_t config_hash = 0;
  std::string version;
  std::int64_t first_utime = 0;
  std::int64_t last_utime = 0;
  std::vector<std::pair<std::string, std::int64_t>>
      counts;  ///< messages by channel, drops by reason
  std::vector<std::string> warnings;
};

/// A part of a drive that was mapped without something that the rig has.
struct DegradedInterval {
  std::string missing;  ///< the channel
  std::int64_t first_utime = 0;
  std::int64_t last_utime = 0;
  std::int32_t first_id = 0;  ///< landmarks first seen then: from this id
  std::int32_t last_id = 0;   ///< to this one; below first_id: none
};

struct MapFolderContent {
  std::vector<mapping::Landmark> landmarks;    ///< in order of id
  std::vector<pose::PoseEstimate> trajectory;  ///< in order of utime
  MapSummary summary;
  std::vector<mapping::Row> rows;  ///< in order of number
  /// Of a map of several drives: the paths of the second and later ones.
  std::vector<std::vector<pose::PoseEstimate>> more_trajectories{};
  std::optional<geometry::Georeference> georeference{};
  std::optional<mapping::SensorView> view{};  ///< where the laser looks; `orchard compare` asks
  std::string ids_csv{};                      ///< of a merged map: ids.csv; empty: there is none
  std::optional<double> tree_scatter_m{};     ///< Mapper::tree_scatter_m() of what made it
  std::vector<DegradedInterval> degraded{};   ///< in order of time
  /// What was seen free, for graph.json; asked while the folder is written.
  mapping::SeenFree seen_free{};
  std::int32_t next_id = 0;  ///< no landmark of an earlier map had this or more
  std::vector<mapping::PlacedPhotograph> photographs{};  ///< whose they are is found out here
  std::size_t album_bytes_max = 0;
};

/// Writes map.csv, map.gpkg, map.svg, map.png, map.pdf, map.html, trajectory.csv and
/// trajectory.tum (trajectory_2.csv ... for more drives), graph.json, summary.json, and ids.csv
/// when there is one, into `folder` (made when missing), all together: written and synced under
/// temporary names before the first is renamed. Equal content gives equal bytes. Throws FileError
/// and then leaves every earlier file as it was.
void write_map_folder(const std::string& folder, const MapFolderContent& content);

}  // namespace orchard::io
