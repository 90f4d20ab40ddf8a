// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "io/map/corrected_map.hpp"
#include "viewer/page_content.hpp"

namespace orchard::procs {

/// The corrections of one map folder between the pages that make them and the file that keeps them,
/// which others may write, too.
class MapEditor {
 public:
  explicit MapEditor(std::string folder) : folder_(std::move(folder)) {}

  /// Makes of `mapped` the correction that a page asks for; `after`: the map with it. The answer
  /// is {"words"} or, with status 400 or 409 and nothing changed, {"problem"}.
  PageAnswer edit(const std::string& json, const io::StoredMap& mapped,
                  io::CorrectedMapFolder& after);

  /// All corrections, when they are others than at the last call; what cannot be read stays as it
  /// was.
  std::optional<std::vector<mapping::Correction>> if_changed();

 private:
  std::string folder_;
  std::mutex mutex_;
  std::string last_state_ = "never looked";
};

/// A whole event of kind "corrections": {"list": [{"n", "when", "who", "words", "outcome",
/// "reason", "note"}], "row_names", "notes", "can_undo", "can_redo"}, the last corrections first.
std::string corrections_event(const io::CorrectedMapFolder& map);

}  // namespace orchard::procs
