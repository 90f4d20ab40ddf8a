// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "geometry/georeference.hpp"
#include "mapping/landmark.hpp"
#include "mapping/rows/navigation_graph.hpp"
#include "mapping/rows/rows.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::view {

/// A picture from above that lies under the map, such as an orthophoto.
struct Background {
  std::string jpeg;
  Eigen::Vector2d low_map, high_map;  ///< corners; its columns run along x
};

/// Content of the page for a map.
struct MapData {
  std::string title;  ///< any text
  std::string version;
  std::int64_t first_utime = 0;
  std::int64_t last_utime = 0;
  std::vector<std::string> warnings;  ///< any text
  const std::vector<mapping::Landmark>* landmarks = nullptr;
  const std::vector<mapping::Row>* rows = nullptr;
  const mapping::NavigationGraph* graph = nullptr;
  std::vector<const std::vector<pose::PoseEstimate>*> paths;  ///< one per drive
  std::optional<geometry::Georeference> georeference;
  /// JPEG files by landmark id.
  std::vector<std::pair<std::int32_t, const std::vector<std::uint8_t>*>> photographs{};
  std::vector<std::int32_t> photo_ids{};  ///< ids whose photographs the page's server has
  std::map<std::int32_t, std::string>
      row_names{};  ///< any text; of rows with another name than their number
  std::map<std::int32_t, std::vector<std::string>> notes{};  ///< any text; by landmark id
};

/// Tolerance of the simplified path on the page [m]: less than a pixel in a view 10 m wide.
/// trajectory.csv has all poses.
inline constexpr double kPathTolerance_m = 0.01;

/// Formats the map as JSON in columns: {"title", "version", "first_utime", "last_utime",
/// "warnings", "georeference", "landmarks": {"id": [...], "label": [kind_number()],
/// "x": [m], ...}, "rows": [{"number", "first", "spacing", "line": [x, y, ...], "gaps": [[position,
/// x, y],
/// ...]}], "ways": [{"kind", "width", "line"}], "paths": [[x, y, ...]], "row_names": {row: text},
/// "notes": {id: [text]}, "photo_ids": [id], "photos": {id: base 64 of a JPEG}}. All members of
/// `map_data` except georeference must be set. Equal maps give equal text; invalid Unicode in texts
/// is replaced.
std::string map_data_json(const MapData& map_data);

/// Formats a member of that object and its comma: "background": {"box": [m], "jpeg": base 64}.
std::string background_json(const Background& background);

/// Formats only the part {"rows", "ways"}, without braces.
std::string rows_and_ways_json(const std::vector<mapping::Row>& rows,
                               const mapping::NavigationGraph& graph);

/// Formats the columns of the landmarks, without georeference: {"id": [...], ...}.
std::string landmark_columns_json(const std::vector<mapping::Landmark>& landmarks,
                                  const std::optional<geometry::Georeference>& georeference);

/// Formats `"row_names": {row: text}, "notes": {id: [text]}`, without braces.
std::string names_and_notes_json(const std::map<std::int32_t, std::string>& row_names,
                                 const std::map<std::int32_t, std::vector<std::string>>& notes);

/// Formats `{"latitude_deg", "longitude_deg", "yaw_rad", "residual_rms_m"}`.
std::string georeference_json(const geometry::Georeference& georeference);

/// Number of a label in the page's detections: 0 tree, 1 object, 2 unseen.
int label_number(detection::Label label);

/// Number of a landmark's kind in the page's columns: 0 tree in a row, 1 object, 2 unseen, 3 other
/// trunk.
int kind_number(const mapping::Landmark& landmark);

/// Formats an arbitrary text as a JSON string in ASCII.
std::string json_text(const std::string& text);

// Parts that the JSON of a whole map and that of its tiles have in common.

/// Formats `[...]` with the output of `text_of` for each item.
template <typename Items, typename TextOf>
std::string array_json(const Items& items, const TextOf& text_of) {
  std::string text = "[";
  for (const auto& item : items) {
    if (text.size() > 1) text += ',';
    text += text_of(item);
  }
  return text + "]";
}

/// Formats `x, y` in metres.
std::string point_text(const Eigen::Vector2d& p);

/// Formats `[x, y, x, y ...]` in metres.
std::string line_json(const std::vector<Eigen::Vector2d>& line);

/// Formats `{"kind", "width", "line"}`: a way, or a part of it.
std::string way_json(const mapping::NavigationEdge& way, const std::vector<Eigen::Vector2d>& line);

/// The trees of a row in order, as a line.
std::vector<Eigen::Vector2d> tree_line(const mapping::Row& row);

/// A robot's path, simplified to kPathTolerance_m.
std::vector<Eigen::Vector2d> path_line(const std::vector<pose::PoseEstimate>& path);

/// Formats the beginning of a page's data: title to georeference, without braces.
std::string heading_json(const MapData& map_data);

/// Formats names, notes and the ids of photographs on a server or beside the page, without braces.
std::string names_and_photo_ids_json(const MapData& map_data);

}  // namespace orchard::view
