// SPDX-License-Identifier: BSD-3-Clause
#include "cli/view/folder_page.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <utility>

#include "cli/maps/stored_content.hpp"
#include "io/file_error.hpp"
#include "io/map/corrections_file.hpp"
#include "io/map/map_folder.hpp"
#include "text/encoded_text.hpp"
#include "text/number_text.hpp"
#include "view/map_data.hpp"
#include "view/page.hpp"

namespace orchard::cli {
namespace {

namespace fs = std::filesystem;
using procs::PageAnswer;

constexpr std::uintmax_t kPhotoMax_bytes = std::uintmax_t{4} << 20;

}  // namespace

FolderPage::FolderPage(const std::string& folder, bool can_edit)
    : folder_(folder), can_edit_(can_edit), editor_(folder) {
  fs::path path = fs::absolute(folder).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  title_ = printable_text(path.filename().string());
  boot_ = std::to_string(std::random_device()());
  io::StoredMap mapped = io::read_stored_map(folder);
  std::error_code error;
  const bool has_album =
      fs::is_directory(fs::path(folder_) / fs::path(io::photo_path(0)).parent_path(), error);
  for (const mapping::Landmark& l : mapped.landmarks) {
    if (!has_album) break;
    if (fs::is_regular_file(fs::path(folder_) / io::photo_path(l.id), error)) {
      photo_ids_.push_back(l.id);
    }
  }
  editor_.if_changed();  // before reading, so that later changes are noticed
  std::vector<mapping::Correction> corrections = io::read_corrections(folder).list;
  show(io::corrected_map_of(std::move(mapped), std::move(corrections)));
}

std::shared_ptr<const FolderPage::Shown> FolderPage::shown() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return shown_;
}

void FolderPage::show(io::CorrectedMapFolder map) {
  std::string corrections = procs::corrections_event(map);
  io::MapSummary summary = summary_of(map.mapped);
  const auto now = std::make_shared<Shown>(Shown{std::move(map), std::move(summary)});
  if (now->map.corrected.landmarks.size() > view::kWholePage_landmarks) {
    now->tiles.emplace(page_data(*now));
  }
  std::string rows =
      now->tiles
          ? "{\"kind\":\"overview\"," + now->tiles->overview_parts_json() + "}"
          : "{\"kind\":\"rows\"," + view::rows_and_ways_json(now->map.rows, now->map.graph) + "}";
  const std::lock_guard<std::mutex> lock(mutex_);
  shown_ = now;
  landmarks_.show(now->map.corrected.landmarks);
  rows_event_ = std::move(rows);
  corrections_event_ = std::move(corrections);
  ++num_shown_;
}

view::MapData FolderPage::page_data(const Shown& shown) const {
  const io::CorrectedMapFolder& map = shown.map;
  view::MapData data;
  data.title = title_;
  data.version = shown.summary.version;
  data.first_utime = shown.summary.first_utime;
  data.last_utime = shown.summary.last_utime;
  data.landmarks = &map.corrected.landmarks;
  data.rows = &map.rows;
  data.graph = &map.graph;
  for (const auto& trajectory : map.mapped.trajectories) data.paths.push_back(&trajectory);
  data.georeference = map.mapped.georeference;
  data.photo_ids = photo_ids_;
  data.row_names = map.corrected.row_names;
  data.notes = map.corrected.notes;
  return data;
}

std::string FolderPage::page() const {
  std::shared_ptr<const Shown> now;
  std::int64_t revision = 0;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    now = shown_;
    revision = landmarks_.revision();
  }
  std::string json =
      now->tiles ? now->tiles->overview_json() : view::map_data_json(page_data(*now));
  json.insert(1, "\"mode\":\"folder\",\"boot\":\"" + boot_ +
                     "\",\"can_edit\":" + (can_edit_ ? "true" : "false") +
                     ",\"revision\":" + std::to_string(revision) + ",");
  return view::page_html(title_, json, view::PageSource::kServer);
}

std::string FolderPage::hello() const { return "{\"kind\":\"hello\",\"boot\":\"" + boot_ + "\"}"; }

std::vector<std::string> FolderPage::events_for(view::ViewerProgress& seen, bool& is_more) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<std::string> events;
  const view::LiveMap::Changes changes =
      landmarks_.changes_since(seen.map, view::LiveState::kLandmarksOfEvent);
  if (changes.revision != seen.map) {
    events.push_back("{\"kind\":\"map\"," + view::landmark_changes_json(changes) + "}");
    seen.map = changes.revision;
  }
  is_more = seen.map < landmarks_.revision();
  if (seen.corrections != num_shown_ && !is_more) {
    seen.corrections = num_shown_;
    events.push_back(rows_event_);
    events.push_back(corrections_event_);
  }
  return events;
}

std::optional<PageAnswer> FolderPage::get(const std::string& name, const Parameters& parameters) {
  const auto id = parameters.find("id"), tile = parameters.find("name");
  if (name == "photo" && id != parameters.end()) return photo(id->second);
  const auto now = shown();
  if (name != "tile" || tile == parameters.end() || !now->tiles) return std::nullopt;
  if (tile->second == "index") {
    return PageAnswer{200, "application/json", now->tiles->index_json()};
  }
  auto json = now->tiles->tile_json(tile->second);
  if (!json) return std::nullopt;
  return PageAnswer{200, "application/json", std::move(*json)};
}

std::optional<PageAnswer> FolderPage::photo(const std::string& text) const {
  const std::optional<std::int32_t> id = whole_number(text);
  if (!id || !std::binary_search(photo_ids_.begin(), photo_ids_.end(), *id)) return std::nullopt;
  const fs::path path = fs::path(folder_) / io::photo_path(*id);
  std::error_code failure;
  if (!fs::is_regular_file(path, failure) || fs::file_size(path, failure) > kPhotoMax_bytes) {
    return std::nullopt;
  }
  std::ifstream file(path, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  return PageAnswer{200, "image/jpeg", std::move(bytes)};
}

PageAnswer FolderPage::edit(const std::string& json) {
  const std::lock_guard<std::mutex> lock(edit_mutex_);
  io::CorrectedMapFolder after;
  PageAnswer answer = editor_.edit(json, shown()->map.mapped, after);
  if (answer.status == 200) show(std::move(after));
  return answer;
}

void FolderPage::look_for_corrections() {
  const std::lock_guard<std::mutex> lock(
      edit_mutex_);  // before reading, so that no concurrent edit is lost
  auto others = editor_.if_changed();
  if (!others) return;
  const auto last = [](const std::vector<mapping::Correction>& list) {
    return list.empty() ? 0 : list.back().number;
  };
  const auto now = shown();
  if (last(*others) == last(now->map.corrections)) return;  // this page's own edit
  show(io::corrected_map_of(now->map.mapped, std::move(*others)));
}

}  // namespace orchard::cli
