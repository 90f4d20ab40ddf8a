// SPDX-License-Identifier: BSD-3-Clause
#include "io/map/map_folder.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>
#include <set>
#include <string>
#include <string_view>

#include "geometry/angles.hpp"
#include "io/atomic_file.hpp"
#include "io/figure/map_figure.hpp"
#include "io/file_error.hpp"
#include "io/folder.hpp"
#include "io/gis/map_layers.hpp"
#include "io/map/background_file.hpp"
#include "io/map/map_csv.hpp"
#include "io/map/plan_names.hpp"
#include "io/map/rounded.hpp"
#include "io/map/stored_map.hpp"
#include "mapping/album/album.hpp"
#include "mapping/kind.hpp"
#include "mapping/rows/navigation_graph.hpp"
#include "text/number_text.hpp"
#include "timing/drive_time.hpp"
#include "view/map_tiles.hpp"
#include "view/page.hpp"

namespace orchard::io {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using mapping::Kind;

constexpr const char* kFolder = "album";
constexpr const char* kTable = "album.csv";

std::string file_name(std::int32_t landmark_id) { return std::to_string(landmark_id) + ".jpg"; }

/// Includes temporary files of a killed process.
bool is_album_file(const std::string& name) {
  static const std::regex kNames(
      "[0-9]+\\.jpg|album\\.csv|\\.([0-9]+|album)\\.[0-9]+-[0-9]+\\.(jpg|csv)");
  return std::regex_match(name, kNames);
}

bool holds(const fs::path& path, std::string_view content) {
  std::error_code error;
  if (fs::file_size(path, error) != content.size() || error) return false;
  std::ifstream file(path, std::ios::binary);
  const std::string there((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  return file && there == content;
}

std::string table_of(const std::vector<mapping::AlbumEntry>& entries) {
  std::string table = "id,image_utime_us,x_px,y_px,width_px,height_px\n";
  for (const mapping::AlbumEntry& entry : entries) {
    const mapping::Photograph& photograph = *entry.photograph;
    table += std::to_string(entry.landmark_id) + "," +
             std::to_string(timing::utime_of(photograph.image_utime)) + "," +
             std::to_string(photograph.frame.x_px) + "," + std::to_string(photograph.frame.y_px) +
             "," + std::to_string(photograph.frame.width_px) + "," +
             std::to_string(photograph.frame.height_px) + "\n";
  }
  return table;
}

/// Includes temporary files of a killed process.
bool is_tile_file(const std::string& name) {
  static const std::regex kNames(
      "(-?[0-9]+_-?[0-9]+|index)\\.js|\\.(-?[0-9]+_-?[0-9]+|index)\\.[0-9]+-[0-9]+\\.js");
  return std::regex_match(name, kNames);
}

double path_length_m(const std::vector<pose::PoseEstimate>& path) {
  double length_m = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    length_m += std::hypot(path[i].x_m - path[i - 1].x_m, path[i].y_m - path[i - 1].y_m);
  }
  return length_m;
}

/// Id above all landmarks of this and earlier maps.
std::int32_t next_id(const MapFolderContent& content) {
  std::int32_t next = std::max(1, content.next_id);
  for (const mapping::Landmark& l : content.landmarks) next = std::max(next, l.id + 1);
  return next;
}

Json view_json(const mapping::SensorView& view) {
  return {{"reach_m", millimetres(view.reach_m)},
          {"bearing_min_rad", rounded(view.bearing_min_rad, 1e6)},
          {"bearing_max_rad", rounded(view.bearing_max_rad, 1e6)},
          {"mount_x_m", millimetres(view.mount_x_m)},
          {"mount_y_m", millimetres(view.mount_y_m)},
          {"mount_yaw_rad", rounded(view.mount_yaw_rad, 1e6)},
          {"min_observations", view.min_observations}};
}

Json georeference_json(const geometry::Georeference& g) {
  // a nanodegree is a tenth of a millimetre
  return {{"latitude_deg", rounded(g.latitude_deg, 1e9)},
          {"longitude_deg", rounded(g.longitude_deg, 1e9)},
          {"altitude_m", millimetres(g.altitude_m)},
          {"x_m", millimetres(g.x_m)},
          {"y_m", millimetres(g.y_m)},
          {"yaw_rad", rounded(g.yaw_rad, 1e9)},
          {"residual_rms_m", millimetres(g.residual_rms_m)},
          {"epsg", geometry::utm_epsg(g)}};
}

/// Warning for a georeference whose residual is above kGeoreferenceResidualMax_m.
std::string residual_warning(const geometry::Georeference& georeference) {
  return "the georeference of the map is doubtful: GNSS fixes deviate by " +
         fixed_text(georeference.residual_rms_m, 2) +
         " m (RMS) from their positions in the map, but at most " +
         fixed_text(geometry::kGeoreferenceResidualMax_m, 1) + " m are expected";
}

/// The hash as text: most readers parse JSON numbers as doubles.
std::string hash_text(std::int64_t hash) {
  return fmt::format("{:016x}", static_cast<std::uint64_t>(hash));
}

MapHeading heading_of(const MapFolderContent& content) {
  MapHeading heading;
  heading.title = content.summary.source.empty() ? "Orchard map" : content.summary.source;
  heading.day = date_text(content.summary.first_utime);
  if (content.georeference) heading.north_rad = 0.5 * geometry::kPi - content.georeference->yaw_rad;
  return heading;
}

/// Writes `map_tiles/` of a map folder: the parts of a large map that map.html loads when they are
/// in view, and which part has which landmark (index.js). As a page on a disk may load scripts but
/// no data, each is a script. Null: removes those of an earlier map. Throws FileError.
void write_map_tiles(const std::string& map_folder, const view::MapTiles* tiles) {
  const std::filesystem::path folder = std::filesystem::path(map_folder) / "map_tiles";
  std::set<std::string> names;
  if (tiles != nullptr) {
    make_folder(folder.string());
    FileReplacement files;
    const auto write = [&](const std::string& name, const std::string& json) {
      names.insert(name + ".js");
      files.write((folder / (name + ".js")).string(),
                  "orchardTile(\"" + name + "\"," + json + ");\n");
    };
    for (const std::string& name : tiles->names()) write(name, *tiles->tile_json(name));
    write("index", tiles->index_json());
    files.commit();
  }
  remove_other_files(folder.string(), names, is_tile_file);
}

/// What map.html shows of a map; `content` must exist as long as it.
view::MapData page_data(const MapFolderContent& content,
                        const std::vector<mapping::AlbumEntry>& album) {
  view::MapData data;
  data.title = content.summary.source.empty() ? "Orchard map" : content.summary.source;
  data.version = content.summary.version;
  data.first_utime = content.summary.first_utime;
  data.last_utime = content.summary.last_utime;
  data.warnings = content.summary.warnings;
  data.landmarks = &content.landmarks;
  data.rows = &content.rows;
  data.graph = &content.graph;
  data.paths.push_back(&content.trajectory);
  for (const auto& trajectory : content.more_trajectories) data.paths.push_back(&trajectory);
  data.georeference = content.georeference;
  data.row_names = mapping::plan_row_names(content.landmarks, content.plan_names);
  for (const mapping::AlbumEntry& entry : album) {
    data.photographs.emplace_back(entry.landmark_id, &entry.photograph->jpeg);
  }
  return data;
}

/// map.html as text: the map as one page, with the album's photographs embedded, that a browser
/// opens from a disk without a network. Equal content gives equal bytes.
std::string map_page(const view::MapData& data) {
  return view::page_html(data.title, view::map_data_json(data), view::PageSource::kFile);
}

/// The same of a large map: its tiles and the album's photographs are files beside the page.
std::string map_page(const view::MapData& data, const view::MapTiles& tiles) {
  return view::page_html(data.title, tiles.overview_json(), view::PageSource::kFileWithTiles);
}

/// summary.json as text: how the map was made, what it contains and what was lost.
std::string summary_json(const MapFolderContent& content) {
  const MapSummary& summary = content.summary;
  Json json;
  json["source"] = summary.source;
  json["version"] = summary.version;
  json["config_hash"] = hash_text(summary.config_hash);
  json["first_utime_us"] = summary.first_utime;
  json["last_utime_us"] = summary.last_utime;
  json["landmarks"]["total"] = content.landmarks.size();
  const mapping::KindCounts kinds(content.landmarks);
  json["landmarks"]["tree"] = kinds.of(Kind::kTree) + kinds.of(Kind::kTrunk);
  json["landmarks"]["tree_in_row"] = kinds.of(Kind::kTree);
  json["landmarks"]["object"] = kinds.of(Kind::kObject);
  json["landmarks"]["unseen"] = kinds.of(Kind::kUnseen);
  if (content.tree_scatter_m) json["tree_scatter_m"] = millimetres(*content.tree_scatter_m);
  json["rows"] = Json::array();
  for (const mapping::Row& row : content.rows) {
    const auto gaps = std::count_if(row.places.begin(), row.places.end(),
                                    [](const auto& place) { return place.landmark_id == 0; });
    json["rows"].push_back({{"row", row.number},
                            {"trees", static_cast<std::int64_t>(row.places.size()) - gaps},
                            {"gaps", gaps},
                            {"spacing_m", millimetres(row.spacing_m)},
                            {"spacing_sd_m", millimetres(mapping::row_spacing(row).sd_m)}});
  }
  json["path"]["num_poses"] = content.trajectory.size();
  json["path"]["length_m"] = millimetres(path_length_m(content.trajectory));
  json["next_id"] = next_id(content);
  if (content.view) json["view"] = view_json(*content.view);
  if (content.georeference) json["georeference"] = georeference_json(*content.georeference);
  for (const DegradedInterval& stretch : content.degraded) {
    Json entry{{"missing", stretch.missing},
               {"first_utime_us", stretch.first_utime},
               {"last_utime_us", stretch.last_utime}};
    if (stretch.last_id >= stretch.first_id) {
      entry["first_landmark"] = stretch.first_id;
      entry["last_landmark"] = stretch.last_id;
    }
    json["degraded"].push_back(std::move(entry));
  }
  json["counts"] = Json::object();
  for (const auto& [name, count] : summary.counts) json["counts"][name] = count;
  json["warnings"] = summary.warnings;
  if (content.georeference &&
      content.georeference->residual_rms_m > geometry::kGeoreferenceResidualMax_m) {
    json["warnings"].push_back(residual_warning(*content.georeference));
  }
  json["quality"] = Json::array();
  for (const Finding& finding : summary.quality) {
    json["quality"].push_back(
        {{"name", finding.name}, {"key", finding.key}, {"text", finding.text}});
  }
  // Names from outside may be invalid UTF-8, which must not prevent writing the map.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

/// Writes album/ID.jpg and album/album.csv (`id,image_utime_us,x_px,y_px,width_px,height_px`: the
/// source image and the crop) into a map folder. Existing files with equal bytes are kept,
/// photographs of other landmarks are removed; without entries the album is removed. Each file is
/// replaced by renaming. Throws FileError.
void write_album(const std::string& map_folder, const std::vector<mapping::AlbumEntry>& entries) {
  const fs::path folder = fs::path(map_folder) / kFolder;
  std::set<std::string> names;
  if (!entries.empty()) {
    make_folder(folder.string());
    FileReplacement files;
    const auto write = [&](const std::string& name, std::string_view content) {
      names.insert(name);
      if (!holds(folder / name, content)) files.write((folder / name).string(), content);
    };
    for (const mapping::AlbumEntry& entry : entries) {
      const std::vector<std::uint8_t>& jpeg = entry.photograph->jpeg;
      write(file_name(entry.landmark_id),
            {reinterpret_cast<const char*>(jpeg.data()), jpeg.size()});
    }
    write(kTable, table_of(entries));
    files.commit();
  }
  remove_other_files(folder.string(), names, is_album_file);
}

}  // namespace

std::string photo_path(std::int32_t landmark_id) {
  return std::string(kFolder) + "/" + file_name(landmark_id);
}

void write_map_folder(const std::string& folder, const MapFolderContent& content) {
  make_folder(folder, "choose another folder for the map");
  const std::filesystem::path path(folder);
  const mapping::RowNames row_names =
      mapping::plan_row_names(content.landmarks, content.plan_names);
  const auto figure = [&](FigureFormat format) {
    return map_figure(content.landmarks, content.trajectory, content.rows, content.graph, format,
                      heading_of(content), row_names);
  };
  const std::vector<mapping::AlbumEntry> album =
      mapping::choose_photographs(content.landmarks, content.photographs, content.album_bytes_max);
  std::map<std::int32_t, std::string> photos;
  for (const mapping::AlbumEntry& entry : album) {
    photos[entry.landmark_id] = photo_path(entry.landmark_id);
  }
  FileReplacement files;
  files.write((path / "map.csv").string(), map_csv(content.landmarks));
  MapLayers layers;
  layers.landmarks = &content.landmarks;
  layers.trajectories = {&content.trajectory};
  for (const auto& trajectory : content.more_trajectories) {
    layers.trajectories.push_back(&trajectory);
  }
  layers.rows = &content.rows;
  layers.graph = &content.graph;
  layers.georeference = &content.georeference;
  layers.photos = photos;
  layers.row_names = row_names;
  files.write((path / "map.gpkg").string(), map_geopackage(layers));
  files.write((path / "map.svg").string(), figure(FigureFormat::kSvg));
  files.write((path / "map.png").string(), figure(FigureFormat::kPng));
  files.write((path / "map.pdf").string(), figure(FigureFormat::kPdf));
  view::MapData page = page_data(content, album);
  std::optional<view::MapTiles> tiles;
  if (content.landmarks.size() > view::kWholePage_landmarks) {
    page.photographs.clear();
    for (const auto& [id, photo] : photos) page.photo_ids.push_back(id);
    tiles.emplace(page);
  }
  std::string html = tiles ? map_page(page, *tiles) : map_page(page);
  if (content.background) {
    write_background(folder, *content.background, files);
    html = view::with_background(html, view::background_json(*content.background));
  }
  files.write((path / "map.html").string(), html);
  files.write((path / "trajectory.csv").string(), trajectory_csv_pieces(content.trajectory));
  files.write((path / "trajectory.tum").string(), trajectory_tum_pieces(content.trajectory));
  for (std::size_t k = 0; k < content.more_trajectories.size(); ++k) {
    files.write((path / ("trajectory_" + std::to_string(k + 2) + ".csv")).string(),
                trajectory_csv_pieces(content.more_trajectories[k]));
  }
  if (!content.ids_csv.empty()) files.write((path / "ids.csv").string(), content.ids_csv);
  if (!content.plan_names.empty()) {
    files.write((path / "names.csv").string(), plan_names_csv(content.plan_names));
  }
  files.write((path / "graph.json").string(), graph_json(content.graph));
  files.write((path / "summary.json").string(), summary_json(content));
  // If the disk is full, every other file remains unchanged.
  write_album(folder, album);
  write_map_tiles(folder, tiles ? &*tiles : nullptr);
  files.commit();
  std::error_code error;
  if (content.plan_names.empty()) fs::remove(path / "names.csv", error);
}

}  // namespace orchard::io
