// SPDX-License-Identifier: BSD-3-Clause
#include "io/map/map_page.hpp"

#include "view/map_data.hpp"
#include "view/page.hpp"

namespace orchard::io {

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
  for (const mapping::AlbumEntry& entry : album) {
    data.photographs.emplace_back(entry.landmark_id, &entry.photograph->jpeg);
  }
  return data;
}

std::string map_page(const view::MapData& data) {
  return view::page_html(data.title, view::map_data_json(data), view::PageSource::kFile);
}

std::string map_page(const view::MapData& data, const view::MapTiles& tiles) {
  return view::page_html(data.title, tiles.overview_json(), view::PageSource::kFileWithTiles);
}

}  // namespace orchard::io
