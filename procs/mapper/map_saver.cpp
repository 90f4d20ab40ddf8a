// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/map_saver.hpp"

#include <malloc.h>

#include <filesystem>
#include <utility>

#include "bus/node/process_options.hpp"
#include "io/atomic_file.hpp"
#include "io/map/map_csv.hpp"
#include "io/map/map_folder.hpp"

namespace orchard::procs {
namespace {

/// Max number of landmarks for saving the whole folder in a running process. Drawing more takes
/// over 0.1 s, during which the node waits; these are drawn at the end.
constexpr std::size_t kDrawnLiveMax = 3000;

/// One save of map.csv is passed over per this many landmarks: finishing a large map takes long.
constexpr std::size_t kSavedEachTime = 1000;

}  // namespace

void MapSaver::save(const MapperNode& mapper, const bus::SaveRequest& request) {
  if (folder_.empty()) return;
  // The first save writes all files while the map is still small, so that users find every file.
  const bool live = request.kind != bus::SaveKind::kFinal;
  const bool quick =
      request.kind == bus::SaveKind::kQuick || mapper.num_landmarks() > kDrawnLiveMax;
  if (live && quick && !saved_table_.empty()) {
    if (num_passed_over_++ < mapper.num_landmarks() / kSavedEachTime) return;
    num_passed_over_ = 0;
    save_table(mapper.finished_landmarks());
  } else {
    save_folder(mapper, request.traffic);
  }
}

void MapSaver::begin_new_map() {
  saved_table_.clear();
  num_passed_over_ = 0;
}

void MapSaver::save_table(const std::vector<mapping::Landmark>& landmarks) {
  std::string table = io::map_csv(landmarks);
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
  summary.warnings = notes_;
  if (std::string warning = mapper.warning(); !warning.empty()) {
    summary.warnings.push_back(std::move(warning));
  }
  io::MapFolderContent content = mapper.content(summary);
  if (!content.trajectory.empty()) {
    content.summary.first_utime = content.trajectory.front().utime;
    content.summary.last_utime = content.trajectory.back().utime;
  }
  std::error_code ignored;  // the write below reports it
  std::filesystem::create_directories(folder_, ignored);
  save_table(content.landmarks);
  io::write_map_folder(folder_, content);
  saved_table_ = io::map_csv(content.landmarks);
  // The content of a long drive takes tens of megabytes, which the allocator would keep.
  content = {};
  ::malloc_trim(0);
}

}  // namespace orchard::procs
