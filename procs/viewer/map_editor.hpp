// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "io/map/corrected_map.hpp"
#include "viewer/page_server.hpp"

namespace orchard::procs {

/// Edits the corrections file of one map folder for the pages; other programs may write the file,
/// too.
class MapEditor {
 public:
  explicit MapEditor(std::string folder) : folder_(std::move(folder)) {}

  /// Adds the correction requested by a page to the map `mapped`; `after` receives the corrected
  /// map. The answer is {"words"} or, with status 400 or 409 and nothing changed, {"problem"}.
  PageAnswer edit(const std::string& json, const io::StoredMap& mapped,
                  io::CorrectedMapFolder& after);

  /// All corrections if they changed since the last call; none if not, or if the file cannot be
  /// read.
  std::optional<std::vector<mapping::Correction>> if_changed();

 private:
  std::string folder_;
  std::mutex mutex_;
  std::string last_state_ = "never looked";
};

/// An event of kind "corrections": {"list": [{"n", "when", "who", "words", "outcome", "reason",
/// "note"}], "row_names", "notes", "can_undo", "can_redo"}, the latest corrections first.
std::string corrections_event(const io::CorrectedMapFolder& map);

}  // namespace orchard::procs
