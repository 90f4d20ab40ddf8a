// SPDX-License-Identifier: BSD-3-Clause
#include "cli/maps/maps.hpp"

#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "bus/node/stop_signal.hpp"
#include "bus/process/process.hpp"
#include "cli/maps/stored_maps.hpp"
#include "cli/view/log_page.hpp"
#include "io/atomic_file.hpp"
#include "io/file_error.hpp"
#include "io/map/background_file.hpp"
#include "io/map/corrected_map.hpp"
#include "io/map/corrections_file.hpp"
#include "io/map/map_folder.hpp"
#include "log_player/replay_rig.hpp"
#include "text/encoded_text.hpp"
#include "text/number_text.hpp"
#include "view/live_state.hpp"
#include "view/map_data.hpp"
#include "view/map_tiles.hpp"
#include "view/page.hpp"
#include "viewer/map_editor.hpp"
#include "viewer/page_server.hpp"
#include "viewer/viewer_process.hpp"

extern char** environ;

namespace orchard::cli {
namespace {

namespace fs = std::filesystem;
using procs::PageAnswer;

constexpr std::size_t kPhotoMax_bytes = std::size_t{4} << 20;

/// The page of a map folder with its corrections, including those that others make meanwhile.
class FolderPage : public procs::PageContent {
 public:
  /// Throws io::FileError. `can_edit`: users of the page may correct the map.
  /// `who`: name that the page suggests to them.
  FolderPage(const std::string& folder, bool can_edit, std::string who)
      : folder_(folder), can_edit_(can_edit), who_(std::move(who)), editor_(folder) {
    fs::path path = fs::absolute(folder).lexically_normal();
    if (!path.has_filename()) path = path.parent_path();
    title_ = printable_text(path.filename().string());
    boot_ = std::to_string(std::random_device()());
    io::StoredMap mapped = io::read_stored_map(folder);
    background_ = io::read_background(folder);
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

  std::string page() const override {
    std::shared_ptr<const Shown> now;
    std::int64_t revision = 0;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      now = shown_;
      revision = landmarks_.revision();
    }
    std::string json =
        now->tiles ? now->tiles->overview_json() : view::map_data_json(page_data(*now));
    if (background_) json.insert(1, view::background_json(*background_));
    json.insert(1, "\"mode\":\"folder\",\"boot\":\"" + boot_ + "\",\"can_edit\":" +
                       (can_edit_ ? "true" : "false") + ",\"who\":" + view::json_text(who_) +
                       ",\"revision\":" + std::to_string(revision) + ",");
    return view::page_html(title_, json, view::PageSource::kServer);
  }
  std::vector<std::string> events_for(view::ViewerProgress& seen, bool& is_more) const override {
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
  std::string hello() const override { return "{\"kind\":\"hello\",\"boot\":\"" + boot_ + "\"}"; }
  /// `photo?id=17`; of a large map `tile?name=3_-2` and `tile?name=index`
  std::optional<procs::PageAnswer> get(const std::string& name,
                                       const Parameters& parameters) override {
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
  bool can_edit() const override { return can_edit_; }
  procs::PageAnswer edit(const std::string& json) override {
    const std::lock_guard<std::mutex> lock(edit_mutex_);
    io::CorrectedMapFolder after;
    PageAnswer answer = editor_.edit(json, shown()->map.mapped, after);
    if (answer.status == 200) show(std::move(after));
    return answer;
  }

  /// Reads corrections that others have written beside the map.
  void look_for_corrections() {
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

 private:
  struct Shown {
    io::CorrectedMapFolder map;
    io::MapSummary summary;
    std::optional<view::MapTiles> tiles{};  ///< of a large map; refers to the other members
  };
  std::shared_ptr<const Shown> shown() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return shown_;
  }
  view::MapData page_data(const Shown& shown) const {
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
  std::optional<procs::PageAnswer> photo(const std::string& text) const {
    const std::optional<std::int32_t> id = whole_number(text);
    if (!id || !std::binary_search(photo_ids_.begin(), photo_ids_.end(), *id)) return std::nullopt;
    const fs::path path = fs::path(folder_) / io::photo_path(*id);
    std::error_code failure;
    if (!fs::is_regular_file(path, failure)) return std::nullopt;
    try {
      return PageAnswer{200, "image/jpeg", io::read_file(path.string(), kPhotoMax_bytes, "")};
    } catch (const io::FileError&) {
      return std::nullopt;  // too large, or removed meanwhile
    }
  }
  void show(io::CorrectedMapFolder map) {
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

  std::string folder_, title_;
  bool can_edit_;
  std::string who_;
  std::string boot_;  ///< identifies this run of the server: the page of an earlier run reloads
  std::vector<std::int32_t> photo_ids_;
  std::optional<view::Background> background_;
  std::mutex edit_mutex_;  ///< serialises edits, so that they are shown in order
  procs::MapEditor editor_;
  mutable std::mutex mutex_;  ///< guards all below, so that readers do not wait for an edit
  std::shared_ptr<const Shown> shown_;
  view::LiveMap landmarks_{0};
  std::string rows_event_, corrections_event_;
  std::int64_t num_shown_ = 0;
};

constexpr int kRefresh_ms = 500;  ///< period of checking for corrections by others

/// Opens the user's browser; does nothing when there is none.
void open_in_browser(const std::string& url) {
  std::string program = "xdg-open", address = url;
  char* arguments[] = {program.data(), address.data(), nullptr};
  posix_spawnattr_t attributes;
  ::posix_spawnattr_init(&attributes);
  sigset_t none;  // the browser must end at Ctrl-C, which this program blocks
  sigemptyset(&none);
  ::posix_spawnattr_setsigmask(&attributes, &none);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  pid_t child = 0;
  if (::posix_spawnp(&child, "xdg-open", nullptr, &attributes, arguments, environ) != 0) {
    std::fprintf(stderr,
                 "orchard view: xdg-open is not installed, so no browser was opened; open the "
                 "address below\n");
  }
  ::posix_spawnattr_destroy(&attributes);
}

/// A temporary file, readable only by this user, that redirects to the page. As a command-line
/// argument of the browser, the token would be visible to all users of this machine. The destructor
/// removes it.
class TokenPage {
 public:
  TokenPage(const std::string& url, const std::string& token) {
    std::error_code error;
    const auto folder = std::filesystem::temp_directory_path(error);
    path_ = (error ? "." : folder.string()) + "/orchard_view_XXXXXX.html";
    const int fd = ::mkstemps(path_.data(), 5);
    if (fd < 0) throw io::FileError(path_ + " cannot be written; set TMPDIR to a folder that can");
    const std::string text = "<!DOCTYPE html><meta http-equiv=\"refresh\" content=\"0;url=" + url +
                             "?token=" + token + "\">\n";
    const ssize_t written = ::write(fd, text.data(), text.size());
    ::close(fd);
    if (written != static_cast<ssize_t>(text.size())) {
      ::unlink(path_.c_str());
      throw io::FileError(path_ + " cannot be written; set TMPDIR to a folder that can");
    }
  }
  ~TokenPage() { ::unlink(path_.c_str()); }
  TokenPage(const TokenPage&) = delete;
  TokenPage& operator=(const TokenPage&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

void require_sense(const ViewOptions& options, bool is_folder) {
  if (options.edit && !is_folder) {
    throw io::FileError(
        "--edit needs a map folder; map the log first (`orchard map`), then run `orchard view "
        "FOLDER --edit`");
  }
  if (is_folder && options.paths.size() > 1) {
    throw io::FileError("give either one map folder or the logs of one drive");
  }
}

}  // namespace

int run_view(const ViewOptions& options) {
  const bool is_folder = std::filesystem::is_directory(options.paths.front());
  require_sense(options, is_folder);
  procs::PageServerOptions server = procs::parse_listen(options.listen);
  if (!options.token_file.empty()) server.token = procs::read_token(options.token_file);
  std::unique_ptr<FolderPage> folder;
  std::optional<procs::ReplayRig> rig;
  const io::LogPaths logs(options.paths);
  if (is_folder) {
    // Without a token only users of this machine open the page.
    folder = std::make_unique<FolderPage>(options.paths.front(), options.edit,
                                          server.token.empty() ? person() : std::string());
  } else {
    rig = procs::choose_rig(logs, options.config_path);
    for (const std::string& note : rig->notes) {
      std::fprintf(stderr, "orchard view: note: %s\n", note.c_str());
    }
  }
  // Before this line Ctrl-C ends the program; from here on all threads block the signals.
  bus::StopSignal stop;
  std::unique_ptr<LogPage> log;
  if (rig) log = std::make_unique<LogPage>(logs, rig->config, ORCHARD_VERSION);
  procs::PageContent& content =
      folder ? static_cast<procs::PageContent&>(*folder) : static_cast<procs::PageContent&>(*log);
  const procs::PageServer page(content, server);
  std::printf("the page is at %s%s%s; stop with Ctrl-C\n", page.url().c_str(),
              server.token.empty() ? "" : "?token=...",
              options.edit ? " (corrections are saved)" : "");
  std::fflush(stdout);
  std::optional<TokenPage> token_page;
  if (options.open && !server.token.empty()) token_page.emplace(page.url(), server.token);
  if (options.open) open_in_browser(token_page ? token_page->path() : page.url());
  bool is_told = false, has_failed = false;
  while (!stop.raised()) {
    stop.wait(-1, kRefresh_ms);
    while (::waitpid(-1, nullptr, WNOHANG) > 0) {  // reap the browser's launcher
    }
    if (folder) folder->look_for_corrections();
    if (log && !is_told && !log->outcome().empty()) {
      is_told = true;
      const std::string outcome = log->outcome();
      has_failed = outcome != "ok";
      if (has_failed) std::fprintf(stderr, "orchard view: %s\n", outcome.c_str());
    }
  }
  return has_failed ? bus::kExitInput : bus::kExitOk;
}

}  // namespace orchard::cli
