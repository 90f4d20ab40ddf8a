// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/map_saver.hpp"

#include <malloc.h>

#include <algorithm>
#include <filesystem>
#include <tuple>
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

/// One more save between two numberings per this many landmarks.
constexpr std::size_t kNumberedEachSave = 1000;

}  // namespace

void MapSaver::save(const MapperNode& mapper, const bus::SaveRequest& request) {
  if (folder_.empty()) return;
  // The first save writes all files while the map is still small, so that users find every file.
  const bool live = request.kind != bus::SaveKind::kFinal;
  const bool quick =
      request.kind == bus::SaveKind::kQuick || mapper.num_landmarks() > kDrawnLiveMax;
  if (live && quick && !saved_table_.empty()) {
    save_table(numbered_landmarks(mapper));
  } else {
    save_folder(mapper, request.traffic);
  }
}

void MapSaver::begin_new_map() {
  saved_table_.clear();
  numbers_.clear();
  long_.clear();
  parts_.clear();
  saves_until_numbering_ = 0;
}

void MapSaver::save_table(const std::vector<mapping::Landmark>& landmarks) {
  std::string table = io::map_csv(landmarks);
  if (table == saved_table_) return;
  io::write_file_atomically((std::filesystem::path(folder_) / "map.csv").string(), table);
  saved_table_ = std::move(table);
}

/// Finding rows takes long in a large map: there, the last numbers are reused for some saves.
std::vector<mapping::Landmark> MapSaver::numbered_landmarks(const MapperNode& mapper) {
  if (--saves_until_numbering_ > 0) {
    std::vector<mapping::Landmark> landmarks = mapper.landmarks();
    const auto is_part = [&](const mapping::Landmark& l) { return parts_.count(l.id) > 0; };
    landmarks.erase(std::remove_if(landmarks.begin(), landmarks.end(), is_part), landmarks.end());
    landmarks.insert(landmarks.end(), long_.begin(), long_.end());
    std::sort(landmarks.begin(), landmarks.end(),
              [](const auto& a, const auto& b) { return a.id < b.id; });
    for (mapping::Landmark& l : landmarks) {
      if (static_cast<std::size_t>(l.id) >= numbers_.size()) continue;
      std::tie(l.row, l.position) = numbers_[static_cast<std::size_t>(l.id)];
    }
    return landmarks;
  }
  std::vector<mapping::Landmark> landmarks = mapper.numbered_landmarks();
  parts_.clear();
  long_.clear();
  for (const mapping::Landmark& l : mapper.landmarks()) parts_.insert(l.id);
  for (const mapping::Landmark& l : landmarks) {
    if (l.length_m == 0.0) parts_.erase(l.id);
    if (l.length_m > 0.0) long_.push_back(l);
  }
  saves_until_numbering_ = 1 + static_cast<int>(landmarks.size() / kNumberedEachSave);
  numbers_.clear();
  for (const mapping::Landmark& l : landmarks) {
    if (static_cast<std::size_t>(l.id) >= numbers_.size()) {
      numbers_.resize(static_cast<std::size_t>(l.id) + 1);
    }
    numbers_[static_cast<std::size_t>(l.id)] = {l.row, l.position};
  }
  return landmarks;
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
