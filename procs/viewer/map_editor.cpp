// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/map_editor.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "io/file_error.hpp"
#include "io/map/corrections_file.hpp"
#include "io/map/map_edit.hpp"
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

/// Reads the fields of a page's request; a wrong type throws io::FileError.
class Fields {
 public:
  explicit Fields(const std::string& text) {
    const auto shallow = [](int depth, Json::parse_event_t, Json&) {
      return depth < kJsonDepthMax;
    };
    json_ = Json::parse(text, shallow, false);
    if (!json_.is_object()) throw io::FileError("an edit must be a JSON object");
  }
  std::string text(const char* key) const {
    const auto at = json_.find(key);
    if (at == json_.end()) return {};
    if (!at->is_string()) throw io::FileError(std::string(key) + " must be a text");
    return at->get<std::string>();
  }
  double number(const char* key) const {
    const auto at = json_.find(key);
    if (at == json_.end()) return 0.0;
    if (!at->is_number()) throw io::FileError(std::string(key) + " must be a number");
    return at->get<double>();
  }
  int integer(const char* key) const {
    const double value = number(key);
    if (!(value >= 0.0 && value <= 1e9) || value != static_cast<int>(value)) {
      throw io::FileError(std::string(key) + " must be a whole number");
    }
    return static_cast<int>(value);
  }
  std::vector<std::string> texts(const char* key) const {
    std::vector<std::string> result;
    for (const Json& json : list(key)) {
      if (!json.is_string()) throw io::FileError(std::string(key) + " must be a list of texts");
      result.push_back(json.get<std::string>());
    }
    return result;
  }
  std::vector<Eigen::Vector2d> places(const char* key) const {
    std::vector<Eigen::Vector2d> result;
    for (const Json& json : list(key)) {
      if (!json.is_array() || json.size() != 2 || !json[0].is_number() || !json[1].is_number()) {
        throw io::FileError(std::string(key) + " must be a list of [x, y]");
      }
      result.push_back({json[0].get<double>(), json[1].get<double>()});
    }
    return result;
  }

 private:
  Json list(const char* key) const {
    const auto at = json_.find(key);
    if (at == json_.end()) return Json::array();
    if (!at->is_array() || at->size() > 100)
      throw io::FileError(std::string(key) + " must be a list");
    return *at;
  }
  Json json_;
};

io::MapEdit edit_of(const Fields& fields) {
  io::MapEdit edit;
  const std::string what = fields.text("what");
  bool is_known = false;
  for (const CorrectionKind kind : mapping::kAllCorrectionKinds) {
    if (what != mapping::correction_word(kind)) continue;
    edit.kind = kind;
    is_known = true;
  }
  if (!is_known) throw io::FileError("field `what` must be delete, add, move, class ...");
  edit.trees = fields.texts("trees");
  edit.places_map = fields.places("places_m");
  if (const std::string word = fields.text("class"); !word.empty()) edit.class_word = word;
  edit.width_m = fields.number("width_m");
  edit.row = fields.text("row");
  edit.name = fields.text("name");
  edit.position = fields.integer("position");
  edit.of = fields.integer("of");
  edit.who = fields.text("who");
  if (edit.who.empty()) edit.who = "unnamed";
  edit.note = fields.text("note");
  return edit;
}

}  // namespace

PageAnswer MapEditor::edit(const std::string& json, const io::StoredMap& mapped,
                           io::CorrectedMapFolder& after) {
  io::MapEdit wanted;
  try {
    wanted = edit_of(Fields(json));
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
