// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "geometry/georeference.hpp"
#include "io/map/map_csv.hpp"
#include "mapping/album/album.hpp"
#include "mapping/compare/visibility.hpp"
#include "mapping/landmark.hpp"
#include "mapping/plan/plan_match.hpp"
#include "mapping/rows/navigation_graph.hpp"
#include "mapping/rows/rows.hpp"
#include "pose/pose_estimate.hpp"
#include "text/finding.hpp"
#include "view/map_data.hpp"

namespace orchard::io {

/// Path of a landmark's photograph in a map folder.
std::string photo_path(std::int32_t landmark_id);

/// Part of summary.json about the run: how the map was made and what was lost.
struct MapSummary {
  std::string source;  ///< log file name (no folder), or "live"
  std::int64_t config_hash = 0;
  std::string version;
  std::int64_t first_utime = 0;
  std::int64_t last_utime = 0;
  std::vector<std::pair<std::string, std::int64_t>>
      counts;  ///< messages by channel, drops by reason
  std::vector<std::string> warnings;
  std::vector<Finding> quality;  ///< what is doubtful about the map, the worst first
};

/// A time interval that was mapped without one of the rig's sensors.
struct DegradedInterval {
  std::string missing;  ///< name of the channel
  std::int64_t first_utime = 0;
  std::int64_t last_utime = 0;
  std::int32_t first_id = 0;  ///< landmarks first seen in the interval: from this id
  std::int32_t last_id = 0;   ///< to this id; below first_id: none
};

struct MapFolderContent {
  std::vector<mapping::Landmark> landmarks;    ///< in order of id
  std::vector<pose::PoseEstimate> trajectory;  ///< in order of utime
  MapSummary summary;
  std::vector<mapping::Row> rows;    ///< in order of number
  mapping::NavigationGraph graph{};  ///< aisles and headland paths
  /// For a map of several drives: the paths of the second and later ones.
  std::vector<std::vector<pose::PoseEstimate>> more_trajectories{};
  std::optional<geometry::Georeference> georeference{};
  std::optional<view::Background> background{};  ///< beneath the page's map
  std::optional<mapping::SensorView> view{};     ///< sensor coverage; used by `orchard compare`
  std::string ids_csv{};                         ///< ids.csv of a merged map; empty: none
  mapping::PlanNames plan_names{};               ///< of the grower's plan; empty: none
  std::optional<double> tree_scatter_m{};        ///< Mapper::tree_scatter_m() of the mapper
  std::vector<DegradedInterval> degraded{};      ///< in order of time
  std::int32_t next_id = 0;                      ///< above every id of this and earlier maps
  std::vector<mapping::PlacedPhotograph> photographs{};  ///< assigned to landmarks when writing
  std::size_t album_bytes_max = 0;
};

/// Writes map.csv, map.gpkg, map.svg, map.png, map.pdf, map.html, trajectory.csv and trajectory.tum
/// (trajectory_2.csv ... for more drives), graph.json, summary.json, map_tiles/ of a large map, and
/// ids.csv and names.csv if there are any, into `folder` (created if missing). All files are
/// written and synced under temporary names before the first is renamed; then names of an earlier
/// map are removed. Equal content gives equal bytes. Throws FileError and then leaves every earlier
/// file unchanged.
void write_map_folder(const std::string& folder, const MapFolderContent& content);

}  // namespace orchard::io
