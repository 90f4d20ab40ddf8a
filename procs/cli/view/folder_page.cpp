// SPDX-License-Identifier: BSD-3-Clause
#include "cli/view/folder_page.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <utility>

#include "cli/maps/stored_content.hpp"
#include "io/file_error.hpp"
#include "io/map/album_files.hpp"
#include "mapping/rows/navigation_graph.hpp"
#include "text/printable_text.hpp"
#include "view/map_data.hpp"
#include "view/page.hpp"

namespace orchard::cli {
namespace {

namespace fs = std::filesystem;
using procs::PageAnswer;

constexpr std::uintmax_t kPhotoMax_bytes = std::uintmax_t{4} << 20;

mapping::NavigationGraph graph_of(const io::CorrectedMapFolder& map) {
  return mapping::navigation_graph(map.corrected.landmarks, map.rows,
                                   content_of(map.mapped).seen_free);
}

}  // namespace

FolderPage::FolderPage(const std::string& folder, bool can_edit)
    : folder_(folder), can_edit_(can_edit), editor_(folder) {
  fs::path path = fs::absolute(folder).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  title_ = printable_text(path.filename().string());
  boot_ = std::to_string(std::random_device()());
  io::StoredMap mapped = io::read_stored_map(folder);
  editor_.if_changed();  // before reading: what is written in between is news
  auto corrections = io::read_corrected_map(folder).corrections;
  map_ = io::corrected_map_of(std::move(mapped), std::move(corrections));
  for (const mapping::Landmark& l : map_.mapped.landmarks) {
    std::error_code error;
    if (fs::is_regular_file(fs::path(folder_) / io::photo_path(l.id), error)) {
      photo_ids_.push_back(l.id);
    }
  }
  show(map_);
}

void FolderPage::show(const io::CorrectedMapFolder& map) {
  shown_.show(map.corrected.landmarks);
  rows_event_ = "{\"kind\":\"rows\"," + view::rows_and_ways_json(map.rows, graph_of(map)) + "}";
  corrections_event_ = procs::corrections_event(map);
  ++num_shown_;
}

std::string FolderPage::page() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const io::MapFolderContent content = content_of(map_.mapped);
  const mapping::NavigationGraph graph = graph_of(map_);
  view::MapData data;
  data.title = title_;
  data.version = content.summary.version;
  data.first_utime = content.summary.first_utime;
  data.last_utime = content.summary.last_utime;
  data.landmarks = &map_.corrected.landmarks;
  data.rows = &map_.rows;
  data.graph = &graph;
  for (const auto& trajectory : map_.mapped.trajectories) data.paths.push_back(&trajectory);
  data.georeference = map_.mapped.georeference;
  data.photo_ids = photo_ids_;
  data.row_names = map_.corrected.row_names;
  data.notes = map_.corrected.notes;
  std::string json = view::map_data_json(data);
  json.insert(1, "\"mode\":\"folder\",\"boot\":\"" + boot_ +
                     "\",\"can_edit\":" + (can_edit_ ? "true" : "false") +
                     ",\"revision\":" + std::to_string(shown_.revision()) + ",");
  return view::page_html(title_, json, view::PageSource::kServer);
}

std::string FolderPage::hello() const { return "{\"kind\":\"hello\",\"boot\":\"" + boot_ + "\"}"; }

std::vector<std::string> FolderPage::events_for(view::Seen& seen, bool& is_more) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<std::string> events;
  const view::LiveMap::Changes changes =
      shown_.changes_since(seen.map, view::LiveState::kLandmarksOfEvent);
  if (changes.revision != seen.map) {
    events.push_back("{\"kind\":\"map\"," + view::landmark_changes_json(changes) + "}");
    seen.map = changes.revision;
  }
  is_more = seen.map < shown_.revision();
  if (seen.corrections != num_shown_ && !is_more) {
    seen.corrections = num_shown_;
    events.push_back(rows_event_);
    events.push_back(corrections_event_);
  }
  return events;
}

std::optional<PageAnswer> FolderPage::get(const std::string& name, const Parameters& parameters) {
  const auto given = parameters.find("id");
  if (name != "photo" || given == parameters.end()) return std::nullopt;
  std::int32_t id = 0;
  const std::string& text = given->second;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if (!std::binary_search(photo_ids_.begin(), photo_ids_.end(), id)) return std::nullopt;
  const fs::path path = fs::path(folder_) / io::photo_path(id);
  std::error_code failure;
  if (!fs::is_regular_file(path, failure) || fs::file_size(path, failure) > kPhotoMax_bytes) {
    return std::nullopt;
  }
  std::ifstream file(path, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  return PageAnswer{200, "image/jpeg", std::move(bytes)};
}

PageAnswer FolderPage::edit(const std::string& json) {
  const std::lock_guard<std::mutex> lock(mutex_);
  io::CorrectedMapFolder after;
  PageAnswer answer = editor_.edit(json, map_.mapped, after);
  if (answer.status != 200) return answer;
  map_ = std::move(after);
  show(map_);
  return answer;
}

void FolderPage::look_for_corrections() {
  const std::lock_guard<std::mutex> lock(mutex_);  // before reading: an edit between would be lost
  auto others = editor_.if_changed();
  if (!others) return;
  const auto last = [](const std::vector<mapping::Correction>& list) {
    return list.empty() ? 0 : list.back().number;
  };
  if (last(*others) == last(map_.corrections)) return;  // this page's own
  map_ = io::corrected_map_of(std::move(map_.mapped), std::move(*others));
  show(map_);
}

}  // namespace orchard::cli
