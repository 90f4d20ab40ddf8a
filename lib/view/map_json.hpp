// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "view/map_data.hpp"

namespace orchard::view {

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
