// SPDX-License-Identifier: BSD-3-Clause
#include "io/map/tree_name.hpp"

#include <algorithm>

#include "detection/detection.hpp"
#include "io/file_error.hpp"
#include "text/whole_number.hpp"

namespace orchard::io {
namespace {

struct RowAndTree {
  std::int32_t row = 0, position = 0;
};

RowAndTree row_and_tree(const CorrectedMapFolder& map, const std::string& name) {
  const std::size_t slash = name.rfind('/');
  const auto position = whole_number(name.substr(slash + 1));
  if (slash == std::string::npos || !position || *position < 1) {
    throw FileError("\"" + name + "\" is not a tree; give an id (17) or row/tree (3/14)");
  }
  return {row_named(map, name.substr(0, slash)), *position};
}

}  // namespace

std::int32_t row_named(const CorrectedMapFolder& map, const std::string& name) {
  for (const auto& [row, row_name] : map.corrected.row_names) {
    if (row_name == name) return row;
  }
  const auto number = whole_number(name);
  const auto& landmarks = map.corrected.landmarks;
  const bool is_there = number && *number > 0 &&
                        std::any_of(landmarks.begin(), landmarks.end(),
                                    [&](const mapping::Landmark& l) { return l.row == *number; });
  if (!is_there) throw FileError(map.mapped.name + " has no row \"" + name + "\"");
  return *number;
}

const mapping::Landmark& landmark_named(const CorrectedMapFolder& map, const std::string& name) {
  const auto& landmarks = map.corrected.landmarks;
  if (const auto id = whole_number(name)) {
    const auto found = std::find_if(landmarks.begin(), landmarks.end(),
                                    [&](const mapping::Landmark& l) { return l.id == *id; });
    if (found != landmarks.end()) return *found;
    throw FileError(map.mapped.name + " has no landmark " + name +
                    ", or it was deleted (`orchard edit MAP list`)");
  }
  const RowAndTree number = row_and_tree(map, name);
  const auto found = std::find_if(landmarks.begin(), landmarks.end(), [&](const auto& l) {
    return l.row == number.row && l.position == number.position;
  });
  if (found != landmarks.end()) return *found;
  throw FileError(map.mapped.name + " has no tree " + std::to_string(number.position) + " in row " +
                  std::to_string(number.row));
}

Eigen::Vector2d gap_named(const CorrectedMapFolder& map, const std::string& name) {
  const RowAndTree number = row_and_tree(map, name);
  for (const mapping::Row& row : map.rows) {
    if (row.number != number.row) continue;
    for (const mapping::RowSlot& place : row.places) {
      if (place.position == number.position && place.landmark_id == 0) return place.p_map;
    }
  }
  throw FileError(map.mapped.name + " has no gap at tree " + std::to_string(number.position) +
                  " of row " + std::to_string(number.row) + "; give the position with --at X Y");
}

std::string landmark_words(const mapping::Landmark& landmark) {
  std::string words = std::to_string(landmark.id) + " (" + label_text(landmark.label);
  if (landmark.row != 0) words += ", row " + std::to_string(landmark.row);
  if (landmark.position != 0) words += " tree " + std::to_string(landmark.position);
  return words + ")";
}

}  // namespace orchard::io
