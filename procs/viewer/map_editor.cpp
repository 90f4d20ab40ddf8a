// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/map_editor.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "io/file_error.hpp"
#include "io/json_value.hpp"
#include "io/map/corrections_file.hpp"
#include "io/map/map_edit.hpp"
#include "io/sane_limits.hpp"
#include "mapping/corrections/apply_corrections.hpp"
#include "text/number_text.hpp"
#include "view/map_data.hpp"

namespace orchard::procs {
namespace {

using Json = nlohmann::ordered_json;
using mapping::Correction;
using mapping::CorrectionKind;

/// Max number of corrections in a page's list; the file has all.
constexpr std::size_t kListedMax = 200;
constexpr int kJsonDepthMax = 8;

PageAnswer problem(int status, const std::string& words) {
  return {status, "application/json", "{\"problem\":" + view::json_text(words) + "}"};
}

/// Parses a page's request, which must not be deep.
Json parsed(const std::string& text) {
  const auto shallow = [](int depth, Json::parse_event_t, Json&) { return depth < kJsonDepthMax; };
  Json json = Json::parse(text, shallow, false);
  if (!json.is_object()) throw io::FileError("an edit must be a JSON object");
  return json;
}

io::MapEdit edit_of(const Json& json) {
  constexpr double kLargest = 1e9;  // derived: more than any number of a row or correction
  const io::JsonSource source{"the edit", "reload the page"};
  const io::JsonValue fields(json, source);
  const auto text = [&](const char* key) { return fields.has(key) ? fields.text(key) : ""; };
  const auto whole = [&](const char* key) {
    return fields.has(key) ? fields.whole(key, 0.0, kLargest) : 0;
  };
  io::MapEdit edit;
  const std::string what = text("what");
  bool is_known = false;
  for (const CorrectionKind kind : mapping::kAllCorrectionKinds) {
    if (what != mapping::correction_word(kind)) continue;
    edit.kind = kind;
    is_known = true;
  }
  if (!is_known) throw io::FileError("field `what` must be delete, add, move, class ...");
  if (fields.has("trees")) edit.trees = fields.texts("trees");
  if (fields.has("places_m")) edit.places_map = fields.places("places_m");
  if (const std::string word = text("class"); !word.empty()) edit.class_word = word;
  if (fields.has("width_m")) edit.width_m = fields.number("width_m", 0.0, io::kMaxWidth_m);
  edit.row = text("row");
  edit.name = text("name");
  edit.position = whole("position");
  edit.of = whole("of");
  edit.who = text("who");
  if (edit.who.empty()) edit.who = "unnamed";
  edit.note = text("note");
  return edit;
}

}  // namespace

PageAnswer MapEditor::edit(const std::string& json, const io::StoredMap& mapped,
                           io::CorrectedMapFolder& after) {
  io::MapEdit wanted;
  try {
    wanted = edit_of(parsed(json));
  } catch (const io::FileError& error) {
    return problem(400, error.what());
  }
  try {
    io::MapEditEffect effect = io::edit_map(folder_, mapped, wanted);
    std::string words = effect.words();
    for (const std::string& sentence : effect.new_conflicts()) words += "; " + sentence;
    after = std::move(effect.after);
    return {200, "application/json", "{\"words\":" + view::json_text(words) + "}"};
  } catch (const io::FileError& error) {
    return problem(409, error.what());
  }
}

std::optional<std::vector<Correction>> MapEditor::if_changed() {
  const std::lock_guard<std::mutex> lock(mutex_);
  struct stat status {};
  std::string state = "none";
  if (::stat((folder_ + "/" + io::kCorrectionsFile).c_str(), &status) == 0) {
    state = std::to_string(status.st_ino) + " " + std::to_string(status.st_size) + " " +
            std::to_string(status.st_mtim.tv_sec) + "." + std::to_string(status.st_mtim.tv_nsec);
  }
  if (state == last_state_) return std::nullopt;
  last_state_ = state;
  try {
    return io::read_corrections(folder_).list;
  } catch (const io::FileError&) {
    return std::nullopt;  // another program is writing it; edit() reports errors
  }
}

std::string corrections_event(const io::CorrectedMapFolder& map) {
  std::string text = "{\"kind\":\"corrections\",\"list\":[";
  const std::size_t total = map.corrections.size();
  for (std::size_t k = 0; k < std::min(total, kListedMax); ++k) {
    const Correction& c = map.corrections[total - 1 - k];
    const mapping::CorrectionResult& result = map.corrected.results.at(total - 1 - k);
    text += std::string(k > 0 ? "," : "") + "{\"n\":" + std::to_string(c.number) +
            ",\"when\":" + view::json_text(io::utc_text(c.utime)) +
            ",\"who\":" + view::json_text(c.who) +
            ",\"words\":" + view::json_text(mapping::correction_words(c)) + ",\"outcome\":\"" +
            mapping::outcome_word(result.outcome) +
            "\",\"reason\":" + view::json_text(result.reason) +
            ",\"note\":" + view::json_text(c.note) + "}";
  }
  return text + "]," + view::names_and_notes_json(map.corrected.row_names, map.corrected.notes) +
         ",\"can_undo\":" + std::to_string(mapping::last_to_undo(map.corrections)) +
         ",\"can_redo\":" + std::to_string(mapping::last_to_redo(map.corrections)) + "}";
}

}  // namespace orchard::procs
