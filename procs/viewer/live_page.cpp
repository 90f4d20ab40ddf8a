// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/live_page.hpp"

#include <algorithm>

#include "mapping/rows/navigation_graph.hpp"
#include "mapping/rows/rows.hpp"
#include "view/map_data.hpp"
#include "view/page.hpp"

namespace orchard::procs {

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

LivePage::LivePage(SharedLiveState& box, MapEditor* editor, const std::string& version)
    : box_(box), editor_(editor), page_(empty_page("live", "Live", version, editor != nullptr)) {}

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

}  // namespace orchard::procs
