// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mapping/kind.hpp"
#include "view/map_data.hpp"

namespace orchard::view {

/// Number of landmarks up to which the page has the whole map: as many as a browser on a busy
/// laptop shows within its first second (tests/RESULTS.md, "first picture").
inline constexpr std::size_t kWholePage_landmarks = 20000;

/// A large map in square tiles, so that a page begins with an overview and fetches only tiles that
/// are in view.
///
/// The overview has the numbers of trees by cells, and thinned lines of rows, ways and paths; a
/// tile has its landmarks, gaps and parts of lines in full. Equal maps give equal text.
class MapTiles {
 public:
  /// What `map_data` points to must exist as long as this object.
  explicit MapTiles(const MapData& map_data);

  double side_m() const { return side_m_; }
  /// Names of all tiles, "COLUMN_ROW".
  std::vector<std::string> names() const;

  /// Formats the data of the page: that of map_data_json() with empty landmarks, thinned lines, and
  /// "tiles": {"stamp", "side" [m], "places": [column, row, number of landmarks ...], "counts":
  /// [trees, objects, unseen], "box" [m], "cells": per side of a tile, "trees", "others": base 64
  /// of a byte per cell and tile, from the lowest row}. Of rows also {"trees", "num_gaps",
  /// "trunk" [m]}.
  std::string overview_json() const;
  /// Formats only {"rows", "ways", "paths", "tiles"}, without braces, in one line (an event).
  std::string overview_parts_json() const;
  /// Formats {"stamp", "landmarks", "gaps": [[row, position, x, y]], "rows": [line], "ways",
  /// "paths"}; none if there is no such tile.
  std::optional<std::string> tile_json(const std::string& name) const;
  /// Formats {"stamp", "ids": [first id, tile ...], "rows": {number: [first position, tile ...]}}:
  /// which tile (by order) landmarks and places are in.
  std::string index_json() const;

 private:
  using Key = std::pair<std::int32_t, std::int32_t>;  ///< column, row
  struct Part {
    std::int32_t line = 0;
    std::vector<Eigen::Vector2d> points_map;
  };
  struct Tile {
    std::vector<std::int32_t> landmarks;
    std::vector<std::pair<std::int32_t, const mapping::RowSlot*>> gaps;  ///< with row's number
    std::vector<Part> rows, ways, paths;
  };
  Key key_of(const Eigen::Vector2d& p_map) const;
  void add_line(const std::vector<Eigen::Vector2d>& line_map, std::int32_t number,
                std::vector<Part> Tile::*parts);
  std::string tiles_json() const;
  std::string cells_json(bool is_of_trees) const;

  MapData data_;
  double side_m_ = 0.0;
  std::string stamp_;
  std::array<std::int64_t, mapping::kNumKinds> counts_{};  ///< by kind_number()
  std::map<Key, Tile> tiles_;
};

}  // namespace orchard::view
