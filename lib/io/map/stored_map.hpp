// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/georeference.hpp"
#include "mapping/compare/visibility.hpp"
#include "mapping/landmark.hpp"
#include "mapping/plan/plan_match.hpp"
#include "mapping/rows/navigation_graph.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::io {

/// graph.json as text, for path planners: nodes with id and position, edges with kind, nodes, rows,
/// length, free width and line, in metres of the map frame.
std::string graph_json(const mapping::NavigationGraph& graph);

/// A map read from its files.
struct StoredMap {
  std::string name;  ///< path of its map.csv, for messages
  std::vector<mapping::Landmark> landmarks;
  std::vector<std::vector<pose::PoseEstimate>> trajectories;  ///< one per drive; empty: unknown
  mapping::SensorView view;  ///< default values if the folder has none
  std::optional<geometry::Georeference> georeference;
  mapping::NavigationGraph graph;   ///< of graph.json; empty if there is none
  mapping::PlanNames plan_names{};  ///< of names.csv; empty if no plan was laid on the map
  std::int32_t next_id = 1;         ///< above every id of this and earlier maps
};

/// Reads a map folder, or only its map.csv (then path, view and graph are unknown).
///
/// Throws FileError naming file, line and column of the first error; also for a map without
/// landmarks, and for one whose coordinates cannot be metres (millimetres, degrees).
StoredMap read_stored_map(const std::string& folder_or_csv);

/// Facts from a map's summary.json that a report mentions; empty if there is no such file.
struct SummaryFacts {
  std::string day;                     ///< date of the drive, "2026-11-22"; empty: unknown
  std::string version;                 ///< version of the program that made the map
  std::optional<bool> has_pictures{};  ///< whether the run had pictures; none: unknown
  double without_pictures_s = 0.0;
  int num_met_without_pictures = 0;  ///< landmarks first seen then
  double without_fixes_s = 0.0;
  std::vector<std::string> warnings;
};

/// Reads the summary.json beside a map.csv or in a map folder; a missing file gives empty facts.
/// `fix_channel`: name under which missing fixes are listed; all other missing inputs are counted
/// as images. `scan_count`, `picture_count`: names under which both are counted. Throws FileError
/// for invalid JSON or another structure.
SummaryFacts read_summary_facts(const std::string& folder_or_csv, std::string_view fix_channel,
                                const std::string& scan_count, const std::string& picture_count);

}  // namespace orchard::io
