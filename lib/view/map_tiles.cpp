// SPDX-License-Identifier: BSD-3-Clause
#include "view/map_tiles.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <unordered_map>

#include "geometry/thinned_line.hpp"
#include "text/encoded_text.hpp"
#include "text/number_text.hpp"
#include "view/map_data.hpp"

namespace orchard::view {
namespace {

using Eigen::Vector2d;
using mapping::Landmark;

/// The largest tile allowed is about 0.8 MB of text: a few of them fill a screen.
constexpr std::int64_t kTile_landmarks = 8000;
constexpr double kSideMost_m = 4096.0, kSideLeast_m = 32.0;

/// Cells per side of a tile in the overview. A tile is about 700 pixels wide on the screen when the
/// page begins to load tiles, and 60 when a million trees are in view: two pixels a cell.
constexpr int kCells = 32;

/// Pixels that a tile is wide at most while the overview is shown; its lines are thinned to one.
constexpr double kOverviewTile_px = 512.0;

std::int32_t tile_number(double coordinate_m, double side_m) {
  return static_cast<std::int32_t>(std::clamp(std::floor(coordinate_m / side_m), -1e6, 1e6));
}

std::int64_t most_in_a_tile(const std::vector<Landmark>& landmarks, double side_m) {
  std::unordered_map<std::int64_t, std::int64_t> counts;
  std::int64_t most = 0;
  for (const Landmark& l : landmarks) {
    const std::int64_t column = tile_number(l.x_m, side_m), row = tile_number(l.y_m, side_m);
    most = std::max(most, ++counts[column * 4000000 + row]);
  }
  return most;
}

/// FNV-1a over what the page shows of each landmark: a page takes no tiles of another map.
std::string stamp_of(const std::vector<Landmark>& landmarks) {
  std::uint64_t sum = 14695981039346656037ull;
  const auto add = [&sum](double value) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    for (int k = 0; k < 64; k += 8) sum = (sum ^ ((bits >> k) & 255)) * 1099511628211ull;
  };
  for (const Landmark& l : landmarks) {
    for (const double value : {l.x_m, l.y_m, l.width_m, l.probability, l.length_m}) add(value);
    for (const int value : {static_cast<int>(l.label), l.id, l.row, l.position}) add(value);
  }
  return fmt::format("{:016x}", sum);
}

/// Fractions of a segment at which it crosses borders of tiles, with 0 and 1.
std::vector<double> crossings(const Vector2d& a, const Vector2d& b, double side_m) {
  std::vector<double> fractions{0.0, 1.0};
  for (const int axis : {0, 1}) {
    const double from = std::min(a[axis], b[axis]), to = std::max(a[axis], b[axis]);
    const std::int32_t last = tile_number(to, side_m);
    for (std::int32_t k = tile_number(from, side_m) + 1; k <= last; ++k) {
      const double fraction = (k * side_m - a[axis]) / (b[axis] - a[axis]);
      if (fraction > 0.0 && fraction < 1.0) fractions.push_back(fraction);
    }
  }
  std::sort(fractions.begin(), fractions.end());
  return fractions;
}

/// Formats `[first, tile, first, tile ...]`: where in an ascending sequence the tile changes.
class Runs {
 public:
  void add(std::int32_t number, std::int32_t tile) {
    if (tile == last_) return;
    last_ = tile;
    if (text_.size() > 1) text_ += ',';
    text_ += std::to_string(number) + "," + std::to_string(tile);
  }
  std::string text() const { return text_ + "]"; }

 private:
  std::string text_ = "[";
  std::int32_t last_ = -1;
};

}  // namespace

MapTiles::Key MapTiles::key_of(const Vector2d& p_map) const {
  return {tile_number(p_map.x(), side_m_), tile_number(p_map.y(), side_m_)};
}

MapTiles::MapTiles(const MapData& map_data)
    : data_(map_data), side_m_(kSideMost_m), stamp_(stamp_of(*map_data.landmarks)) {
  const std::vector<Landmark>& landmarks = *data_.landmarks;
  while (side_m_ > kSideLeast_m && most_in_a_tile(landmarks, side_m_) > kTile_landmarks) {
    side_m_ *= 0.5;
  }
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const Landmark& l = landmarks[i];
    tiles_[key_of({l.x_m, l.y_m})].landmarks.push_back(static_cast<std::int32_t>(i));
    ++counts_[static_cast<std::size_t>(kind_number(l))];
  }
  for (const mapping::Row& row : *data_.rows) {
    for (const mapping::RowSlot& place : row.places) {
      if (place.landmark_id == 0) {
        tiles_[key_of(place.p_map)].gaps.emplace_back(row.number, &place);
      }
    }
    add_line(tree_line(row), row.number, &Tile::rows);
  }
  const auto& ways = data_.graph->edges;
  for (std::size_t k = 0; k < ways.size(); ++k) {
    add_line(ways[k].line_map, static_cast<std::int32_t>(k), &Tile::ways);
  }
  for (std::size_t k = 0; k < data_.paths.size(); ++k) {
    add_line(path_line(*data_.paths[k]), static_cast<std::int32_t>(k), &Tile::paths);
  }
}

void MapTiles::add_line(const std::vector<Vector2d>& line_map, std::int32_t number,
                        std::vector<Part> Tile::*parts) {
  std::optional<Key> current;
  for (std::size_t k = 1; k < line_map.size(); ++k) {
    const Vector2d &a = line_map[k - 1], &b = line_map[k];
    const std::vector<double> fractions = crossings(a, b, side_m_);
    for (std::size_t c = 1; c < fractions.size(); ++c) {
      const auto at = [&](double fraction) { return Vector2d(a + fraction * (b - a)); };
      const Key key = key_of(at(0.5 * (fractions[c - 1] + fractions[c])));
      auto& of_tile = tiles_[key].*parts;
      if (key != current) of_tile.push_back({number, {at(fractions[c - 1])}});
      of_tile.back().points_map.push_back(at(fractions[c]));
      current = key;
    }
  }
}

std::vector<std::string> MapTiles::names() const {
  std::vector<std::string> names;
  for (const auto& [key, tile] : tiles_) {
    names.push_back(fmt::format("{}_{}", key.first, key.second));
  }
  return names;
}

std::string MapTiles::cells_json(bool is_of_trees) const {
  const mapping::KindCounts kinds(*data_.landmarks);
  std::string text = "[";
  for (const auto& [key, tile] : tiles_) {
    std::array<std::uint8_t, kCells * kCells> cells{};
    bool is_any = false;
    for (const std::int32_t i : tile.landmarks) {
      const Landmark& l = (*data_.landmarks)[static_cast<std::size_t>(i)];
      if (kinds.counts(mapping::kind_of(l)) != is_of_trees) continue;
      const auto cell = [&](double coordinate_m, std::int32_t number) {
        const double fraction = coordinate_m / side_m_ - number;
        return static_cast<std::size_t>(std::clamp(fraction * kCells, 0.0, kCells - 1.0));
      };
      std::uint8_t& count = cells[cell(l.y_m, key.second) * kCells + cell(l.x_m, key.first)];
      if (count < 255) ++count;
      is_any = true;
    }
    if (text.size() > 1) text += ',';
    text += '"' + (is_any ? base64_text(cells.data(), cells.size()) : std::string()) + '"';
  }
  return text + "]";
}

std::string MapTiles::tiles_json() const {
  Eigen::AlignedBox2d box;
  for (const Landmark& l : *data_.landmarks) box.extend(Vector2d(l.x_m, l.y_m));
  for (const auto* path : data_.paths) {
    for (const pose::PoseEstimate& pose : *path) box.extend(Vector2d(pose.x_m, pose.y_m));
  }
  std::string text = "{\"stamp\":\"" + stamp_ + "\",\"side\":" + fixed_text(side_m_, 0);
  text += ",\"places\":" + array_json(tiles_, [](const auto& entry) {
            return fmt::format("{},{},{}", entry.first.first, entry.first.second,
                               entry.second.landmarks.size());
          });
  text += ",\"counts\":" + array_json(counts_, [](std::int64_t n) { return std::to_string(n); });
  if (!box.isEmpty()) text += ",\"box\":" + line_json({box.min(), box.max()});
  text += ",\"cells\":" + std::to_string(kCells) + ",\"trees\":" + cells_json(true) +
          ",\"others\":" + cells_json(false);
  return text + "}";
}

std::string MapTiles::overview_parts_json() const {
  const double tolerance_m = side_m_ / kOverviewTile_px;
  std::map<std::int32_t, std::pair<std::int64_t, double>> trunks;  // by row: number, sum of widths
  for (const Landmark& l : *data_.landmarks) {
    if (mapping::kind_of(l) != mapping::Kind::kTree) continue;
    auto& [number, sum_m] = trunks[l.row];
    ++number;
    sum_m += l.width_m;
  }
  const auto row_text = [&](const mapping::Row& row) {
    std::int64_t num_gaps = 0;
    for (const mapping::RowSlot& place : row.places) num_gaps += place.landmark_id == 0 ? 1 : 0;
    const auto& [number, sum_m] = trunks[row.number];
    const double mean_m = number > 0 ? sum_m / static_cast<double>(number) : 0.0;
    return fmt::format(
        R"({{"number":{},"first":{},"spacing":{},"line":{},"gaps":[],"trees":{},"num_gaps":{},"trunk":{}}})",
        row.number, row.places.front().position, fixed_text(row.spacing_m, 3),
        line_json(geometry::thinned_line(tree_line(row), tolerance_m)), number, num_gaps,
        fixed_text(mean_m, 4));
  };
  return "\"rows\":" + array_json(*data_.rows, row_text) + ",\"ways\":" +
         array_json(data_.graph->edges,
                    [&](const mapping::NavigationEdge& way) {
                      return way_json(way, geometry::thinned_line(way.line_map, tolerance_m));
                    }) +
         ",\"paths\":" +
         array_json(data_.paths,
                    [&](const auto* path) {
                      return line_json(geometry::thinned_line(path_line(*path), tolerance_m));
                    }) +
         ",\"tiles\":" + tiles_json();
}

std::string MapTiles::overview_json() const {
  return "{" + heading_json(data_) + ",\n\"landmarks\":{},\n" + overview_parts_json() + ",\n" +
         names_and_photo_ids_json(data_) + "}";
}

std::optional<std::string> MapTiles::tile_json(const std::string& name) const {
  const std::vector<std::string> all = names();
  const auto place = std::find(all.begin(), all.end(), name);
  if (place == all.end()) return std::nullopt;
  const Tile& tile = std::next(tiles_.begin(), place - all.begin())->second;
  std::vector<Landmark> landmarks;
  for (const std::int32_t i : tile.landmarks) {
    landmarks.push_back((*data_.landmarks)[static_cast<std::size_t>(i)]);
  }
  const auto line_of = [](const Part& part) { return line_json(part.points_map); };
  const auto gap_json = [](const auto& gap) {
    const auto& [row, slot] = gap;
    return fmt::format("[{},{},{}]", row, slot->position, point_text(slot->p_map));
  };
  const auto part_json = [&](const Part& part) {
    return way_json(data_.graph->edges[static_cast<std::size_t>(part.line)], part.points_map);
  };
  return fmt::format(
      R"({{"stamp":"{}","landmarks":{},
"gaps":{},
"rows":{},
"ways":{},
"paths":{}}})",
      stamp_, landmark_columns_json(landmarks, data_.georeference), array_json(tile.gaps, gap_json),
      array_json(tile.rows, line_of), array_json(tile.ways, part_json),
      array_json(tile.paths, line_of));
}

std::string MapTiles::index_json() const {
  std::map<Key, std::int32_t> numbers;
  for (const auto& [key, tile] : tiles_) {
    numbers.emplace(key, static_cast<std::int32_t>(numbers.size()));
  }
  std::vector<std::pair<std::int32_t, std::int32_t>> of_ids;
  for (const Landmark& l : *data_.landmarks) {
    of_ids.emplace_back(l.id, numbers[key_of({l.x_m, l.y_m})]);
  }
  std::sort(of_ids.begin(), of_ids.end());
  Runs ids;
  for (const auto& [id, tile] : of_ids) ids.add(id, tile);
  std::string rows = "{";
  for (const mapping::Row& row : *data_.rows) {
    Runs places;
    for (const mapping::RowSlot& slot : row.places) {
      places.add(slot.position, numbers[key_of(slot.p_map)]);
    }
    if (rows.size() > 1) rows += ",\n";
    rows += "\"" + std::to_string(row.number) + "\":" + places.text();
  }
  return "{\"stamp\":\"" + stamp_ + "\",\"ids\":" + ids.text() + ",\n\"rows\":" + rows + "}}";
}

}  // namespace orchard::view
