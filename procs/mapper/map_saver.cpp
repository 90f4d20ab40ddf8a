// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/map_saver.hpp"

#include <filesystem>
#include <utility>

#include "bus/node/process_options.hpp"
#include "io/atomic_file.hpp"
#include "io/map/map_csv.hpp"
#include "io/map/map_folder.hpp"

namespace orchard::procs {
namespace {

/// Drawing more than this takes over 0.1 s, and the node waits meanwhile: it is left to the end.
constexpr std::size_t kDrawnLiveMost = 3000;

}  // namespace

void MapSaver::save(const MapperNode& mapper, const bus::SaveRequest& request) {
  if (folder_.empty()) return;
  // The first save makes the folder and every file in it, while the map is still small: who looks
  // finds them all, and a folder that cannot be written shows in STATUS at once.
  const bool live = request.kind != bus::SaveKind::kFinal;
  const bool quick =
      request.kind == bus::SaveKind::kQuick || mapper.num_landmarks() > kDrawnLiveMost;
  if (live && quick && !saved_table_.empty()) {
    save_table(mapper);
  } else {
    save_folder(mapper, request.traffic);
  }
}

void MapSaver::save_table(const MapperNode& mapper) {
  std::string table = io::map_csv(mapper.landmarks());
  if (table == saved_table_) return;
  io::write_file_atomically((std::filesystem::path(folder_) / "map.csv").string(), table);
  saved_table_ = std::move(table);
}

void MapSaver::save_folder(const MapperNode& mapper, const bus::TrafficCounts& traffic) {
  io::MapSummary summary;
  summary.source = "live";
  summary.config_hash = config_hash_;
  summary.version = bus::version();
  summary.counts = bus::named_counts(traffic, {&mapper});
  io::MapFolderContent content = mapper.content(summary);
  if (!content.trajectory.empty()) {
    content.summary.first_utime = content.trajectory.front().utime;
    content.summary.last_utime = content.trajectory.back().utime;
  }
  io::write_map_folder(folder_, content);
  saved_table_ = io::map_csv(content.landmarks);
}

}  // namespace orchard::procs
