// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/live_page.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>

#include "mapping/rows/navigation_graph.hpp"
#include "mapping/rows/row_numbers.hpp"
#include "mapping/rows/rows.hpp"
#include "view/map_data.hpp"
#include "view/page.hpp"

namespace orchard::procs {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kPeriodMin{2};
constexpr int kRestPerWork = 20;  ///< limits the load to a twentieth of a core

}  // namespace

std::string empty_page(const std::string& mode, const std::string& title,
                       const std::string& version, bool can_edit, const std::string& boot) {
  const std::vector<mapping::Landmark> landmarks;
  const std::vector<mapping::Row> rows;
  const mapping::NavigationGraph graph;
  view::MapData data;
  data.title = title;
  data.version = version;
  data.landmarks = &landmarks;
  data.rows = &rows;
  data.graph = &graph;
  std::string json = view::map_data_json(data);
  json.insert(1, "\"mode\":\"" + mode + "\",\"boot\":\"" + boot +
                     "\",\"can_edit\":" + (can_edit ? "true," : "false,"));
  return view::page_html("Orchard: " + title, json, view::PageSource::kServer);
}

LivePage::LivePage(SharedLiveState& box, MapEditor* editor, const std::string& title,
                   const std::string& version)
    : box_(box), editor_(editor), page_(empty_page("live", title, version, editor != nullptr)) {}

std::optional<PageAnswer> LivePage::get(const std::string& name, const Parameters&) {
  if (name != "picture") return std::nullopt;
  const auto picture = box_.picture();
  if (!picture) return std::nullopt;
  return PageAnswer{200, picture->type, picture->bytes};
}

PageAnswer LivePage::edit(const std::string& json) {
  const std::lock_guard<std::mutex> lock(edit_mutex_);  // concurrent edits are shown in order
  io::StoredMap map;
  map.name = "the map so far";
  map.landmarks = box_.landmarks();
  for (const mapping::Landmark& l : map.landmarks) map.next_id = std::max(map.next_id, l.id + 1);
  io::CorrectedMapFolder after;
  PageAnswer answer = editor_->edit(json, map, after);
  if (answer.status == 200)
    box_.take_corrected(after.corrected.landmarks, corrections_event(after));
  return answer;
}

RowSurvey::RowSurvey(SharedLiveState& box, const mapping::RowsConfig& config, MapEditor* editor)
    : box_(box), config_(config), editor_(editor), thread_([this] { run(); }) {}

RowSurvey::~RowSurvey() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_stopping_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void RowSurvey::run() {
  std::int64_t surveyed = 0;
  std::shared_ptr<const mapping::NavigationGraph> surveyed_ways;
  Clock::duration rest = kPeriodMin;
  std::unique_lock<std::mutex> lock(mutex_);
  while (!wake_.wait_for(lock, rest, [this] { return is_stopping_; })) {
    const std::int64_t revision = box_.map_revision();
    rest = kPeriodMin;
    std::optional<std::vector<mapping::Correction>> others;
    if (editor_ != nullptr) others = editor_->if_changed();
    if (others) corrections_ = std::move(*others);
    const std::shared_ptr<const mapping::NavigationGraph> ways = box_.ways();
    if (revision == surveyed && ways == surveyed_ways && !others) continue;
    surveyed_ways = ways;
    lock.unlock();
    const Clock::time_point begin = Clock::now();
    std::vector<mapping::Landmark> landmarks = box_.landmarks();
    std::vector<mapping::Row> rows;
    mapping::NavigationGraph graph;  // of the finished map only: MAP does not tell of free ground
    if (ways != nullptr) graph = *ways;
    if (config_.has_rows() && ways == nullptr) {
      mapping::number_landmarks(mapping::find_rows(landmarks, config_), landmarks);
    }
    rows = mapping::numbered_rows(landmarks);
    const std::vector<mapping::Landmark> numbered = landmarks;
    // Include corrections made during the search: otherwise the page would lose them until the next
    // one.
    if (editor_ != nullptr) {
      if (auto newest = editor_->if_changed()) corrections_ = std::move(*newest);
    }
    if (!corrections_.empty()) {
      io::StoredMap mapped;
      mapped.landmarks = std::move(landmarks);
      mapped.graph = std::move(graph);
      io::CorrectedMapFolder corrected = io::corrected_map_of(std::move(mapped), corrections_);
      box_.take_corrected(corrected.corrected.landmarks, corrections_event(corrected));
      rows = std::move(corrected.rows);
      graph = std::move(corrected.graph);
    }
    const std::int64_t num_own = box_.take_rows(numbered, view::rows_and_ways_json(rows, graph));
    surveyed = revision + num_own;  // counts own changes as surveyed, concurrent ones not
    rest = std::max<Clock::duration>(kPeriodMin, kRestPerWork * (Clock::now() - begin));
    lock.lock();
  }
}

}  // namespace orchard::procs
