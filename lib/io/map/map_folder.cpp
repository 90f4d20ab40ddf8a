// SPDX-License-Identifier: BSD-3-Clause
#include "io/map/map_folder.hpp"

#include <filesystem>
#include <map>
#include <optional>

#include "geometry/angles.hpp"
#include "io/atomic_file.hpp"
#include "io/figure/map_figure.hpp"
#include "io/folder.hpp"
#include "io/gis/map_layers.hpp"
#include "io/map/album_files.hpp"
#include "io/map/graph_json.hpp"
#include "io/map/map_page.hpp"
#include "io/map/map_tile_files.hpp"
#include "io/map/summary_json.hpp"
#include "io/map/trajectory_csv.hpp"
#include "mapping/album/album.hpp"
#include "text/date_text.hpp"

namespace orchard::io {
namespace {

MapHeading heading_of(const MapFolderContent& content) {
  MapHeading heading;
  heading.title = content.summary.source.empty() ? "Orchard map" : content.summary.source;
  heading.day = date_text(content.summary.first_utime);
  if (content.georeference) heading.north_rad = 0.5 * geometry::kPi - content.georeference->yaw_rad;
  return heading;
}

}  // namespace

void write_map_folder(const std::string& folder, const MapFolderContent& content) {
  make_folder(folder, "choose another folder for the map");
  const std::filesystem::path path(folder);
  const auto figure = [&content, heading = heading_of(content)](FigureFormat format) {
    return map_figure(content.landmarks, content.trajectory, content.rows, content.graph, format,
                      heading);
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
  files.write((path / "map.html").string(), tiles ? map_page(page, *tiles) : map_page(page));
  files.write((path / "trajectory.csv").string(), trajectory_csv_pieces(content.trajectory));
  files.write((path / "trajectory.tum").string(), trajectory_tum_pieces(content.trajectory));
  for (std::size_t k = 0; k < content.more_trajectories.size(); ++k) {
    files.write((path / ("trajectory_" + std::to_string(k + 2) + ".csv")).string(),
                trajectory_csv_pieces(content.more_trajectories[k]));
  }
  if (!content.ids_csv.empty()) files.write((path / "ids.csv").string(), content.ids_csv);
  files.write((path / "graph.json").string(), graph_json(content.graph));
  files.write((path / "summary.json").string(), summary_json(content));
  // If the disk is full, every other file remains unchanged.
  write_album(folder, album);
  write_map_tiles(folder, tiles ? &*tiles : nullptr);
  files.commit();
}

}  // namespace orchard::io
