// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <nlohmann/json.hpp>

#include "detection/detection.hpp"
#include "io/file_error.hpp"
#include "io/map/corrections_file.hpp"
#include "io/map/rounded.hpp"
#include "io/sane_limits.hpp"
#include "text/printable_text.hpp"

namespace orchard::io {
namespace {

using detection::Label;
using Eigen::Vector2d;
using mapping::Correction;
using mapping::CorrectionKind;
using mapping::CorrectionTarget;
using Json = nlohmann::ordered_json;

constexpr std::size_t kLineMax_bytes = 65536;
constexpr std::size_t kTargetsMax = 100;

constexpr std::int64_t kMaxInt = std::numeric_limits<std::int32_t>::max() - 1;

double metres(double value) { return rounded(value, 1e4); }

Json target_json(const CorrectionTarget& target) {
  Json json{{"id", target.id},
            {"x_m", metres(target.p_map.x())},
            {"y_m", metres(target.p_map.y())},
            {"class", label_text(target.label)}};
  if (target.width_m > 0.0) json["width_m"] = metres(target.width_m);
  return json;
}

/// The fields of one line, with type checks.
class Line {
 public:
  Line(std::string_view text, std::string place) : place_(std::move(place)) {
    json_ = Json::parse(text, nullptr, false);
    if (!json_.is_object()) fail("is not a JSON object");
  }

  [[noreturn]] void fail(const std::string& why) const {
    throw FileError(place_ + ": " + why + "; correct or remove the line");
  }

  std::int64_t integer(const Json& json, const char* key, std::int64_t lo) const {
    if (!json.contains(key) || !json[key].is_number_integer()) {
      fail(std::string(key) + " must be a whole number");
    }
    const auto value = json[key].get<std::int64_t>();
    if (value < lo || value > kMaxInt) fail(std::string(key) + " is out of range");
    return value;
  }
  std::int32_t integer(const char* key, std::int64_t lo) {
    used_.push_back(key);
    return static_cast<std::int32_t>(integer(json_, key, lo));
  }
  std::string text(const char* key) {
    used_.push_back(key);
    if (!json_.contains(key) || !json_[key].is_string()) fail(std::string(key) + " must be a text");
    auto value = json_[key].get<std::string>();
    if (!is_correction_text(value)) {
      fail(std::string(key) + " is too long, or contains control characters");
    }
    return value;
  }
  bool has(const char* key) const { return json_.contains(key); }

  double number(const Json& json, double lo, double hi, const char* key) const {
    if (!json.is_number()) fail(std::string(key) + " must be a number");
    const double value = json.get<double>();
    if (!std::isfinite(value) || value < lo || value > hi) {
      fail(std::string(key) + " is out of range");
    }
    return value;
  }
  double width_m() {
    used_.push_back("width_m");
    return has("width_m") ? number(json_["width_m"], 0.0, kMaxWidth_m, "width_m") : 0.0;
  }
  Label label(const Json& json) const {
    const std::string word =
        json.contains("class") && json["class"].is_string() ? json["class"].get<std::string>() : "";
    for (const Label label : {Label::kTree, Label::kObject, Label::kUnseen}) {
      if (word == label_text(label)) return label;
    }
    fail("class must be tree, object or unseen");
  }
  Label label() {
    used_.push_back("class");
    return label(json_);
  }
  std::vector<CorrectionTarget> targets(std::size_t least, std::size_t most) {
    used_.push_back("landmarks");
    if (!has("landmarks") || !json_["landmarks"].is_array()) fail("landmarks must be a list");
    const Json& list = json_["landmarks"];
    if (list.size() < least || list.size() > most)
      fail("landmarks has the wrong number of landmarks for this correction");
    std::vector<CorrectionTarget> result;
    for (const Json& json : list) {
      if (!json.is_object()) fail("landmarks must be a list of objects");
      for (const char* key : {"x_m", "y_m"}) {
        if (!json.contains(key)) fail(std::string("a landmark has no ") + key);
      }
      CorrectionTarget target;
      target.id = static_cast<std::int32_t>(integer(json, "id", 0));
      target.p_map = {number(json["x_m"], -kMaxCoordinate_m, kMaxCoordinate_m, "x_m"),
                      number(json["y_m"], -kMaxCoordinate_m, kMaxCoordinate_m, "y_m")};
      target.label = label(json);
      if (json.contains("width_m")) {
        target.width_m = number(json["width_m"], 0.0, kMaxWidth_m, "width_m");
      }
      result.push_back(target);
    }
    return result;
  }
  std::vector<Vector2d> places(std::size_t count) {
    used_.push_back("places_m");
    if (!has("places_m") || !json_["places_m"].is_array() || json_["places_m"].size() != count) {
      fail("places_m must be " + std::to_string(count) + " [x, y]");
    }
    std::vector<Vector2d> result;
    for (const Json& json : json_["places_m"]) {
      if (!json.is_array() || json.size() != 2) fail("places_m must be a list of [x, y]");
      result.push_back({number(json[0], -kMaxCoordinate_m, kMaxCoordinate_m, "places_m"),
                        number(json[1], -kMaxCoordinate_m, kMaxCoordinate_m, "places_m")});
    }
    return result;
  }
  CorrectionKind kind() {
    const std::string word = text("what");
    for (const CorrectionKind kind : mapping::kAllCorrectionKinds) {
      if (word == mapping::correction_word(kind)) return kind;
    }
    fail("\"" + printable_text(word) +
         "\" is a kind of correction that this version does not know");
  }
  std::int64_t utime() {
    const std::string when = text("when");
    std::tm utc{};
    const char* end = ::strptime(when.c_str(), "%Y-%m-%dT%H:%M:%SZ", &utc);
    if (end == nullptr || *end != '\0') fail("`when` must be a time like 2026-05-04T08:00:00Z");
    return std::int64_t{1000000} * static_cast<std::int64_t>(::timegm(&utc));
  }
  /// An unknown field is from a later release or a mistake, so it is an error.
  void require_all_used() const {
    for (const auto& [key, value] : json_.items()) {
      if (std::find(used_.begin(), used_.end(), key) == used_.end()) {
        fail("\"" + printable_text(key) + "\" does not belong to this kind of correction");
      }
    }
  }

 private:
  std::string place_;
  Json json_;
  std::vector<std::string> used_;
};

Correction correction_of(Line& line) {
  Correction c;
  c.number = line.integer("n", 1);
  c.utime = line.utime();
  c.who = line.text("who");
  c.kind = line.kind();
  switch (c.kind) {
    case CorrectionKind::kDelete:
    case CorrectionKind::kNote:
      c.targets = line.targets(1, 1);
      break;
    case CorrectionKind::kAdd:
      c.places_map = line.places(1);
      c.new_id = line.integer("new_id", 1);
      c.label = line.label();
      c.width_m = line.width_m();
      break;
    case CorrectionKind::kMove:
      c.targets = line.targets(1, 1);
      c.places_map = line.places(1);
      break;
    case CorrectionKind::kClass:
      c.targets = line.targets(1, 1);
      c.label = line.label();
      break;
    case CorrectionKind::kMerge:
      c.targets = line.targets(2, kTargetsMax);
      c.places_map = line.places(1);
      break;
    case CorrectionKind::kSplit:
      c.targets = line.targets(1, 1);
      c.places_map = line.places(2);
      c.new_id = line.integer("new_id", 1);
      break;
    case CorrectionKind::kRowName:
      c.row = line.integer("row", 1);
      c.name = line.text("name");
      break;
    case CorrectionKind::kRenumber:
      c.targets = line.targets(1, 1);
      c.row = line.integer("row", 1);
      c.position = line.integer("position", 0);
      break;
    case CorrectionKind::kUndo:
    case CorrectionKind::kRedo:
      c.of = line.integer("of", 1);
      break;
  }
  if (line.has("note")) c.note = line.text("note");
  if (c.kind == CorrectionKind::kNote && c.note.empty()) line.fail("the note is empty");
  line.require_all_used();
  return c;
}

}  // namespace

bool is_correction_text(const std::string& text) {
  if (text.size() > kCorrectionTextMax_bytes || printable_text(text) != text) return false;
  try {
    return !Json(text).dump().empty();
  } catch (const Json::exception&) {
    return false;  // not UTF-8
  }
}

std::string utc_text(std::int64_t utime) {
  const auto seconds = static_cast<std::time_t>(utime / 1000000);
  std::tm utc{};
  ::gmtime_r(&seconds, &utc);
  char text[40];
  std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

std::string correction_line(const Correction& c) {
  Json json{{"n", c.number}, {"when", utc_text(c.utime)}, {"who", c.who}};
  json["what"] = mapping::correction_word(c.kind);
  if (c.of != 0) json["of"] = c.of;
  for (const CorrectionTarget& target : c.targets) json["landmarks"].push_back(target_json(target));
  for (const Vector2d& p : c.places_map) {
    json["places_m"].push_back(Json::array({metres(p.x()), metres(p.y())}));
  }
  if (c.new_id != 0) json["new_id"] = c.new_id;
  if (c.kind == CorrectionKind::kAdd || c.kind == CorrectionKind::kClass) {
    json["class"] = label_text(c.label);
  }
  if (c.kind == CorrectionKind::kAdd && c.width_m > 0.0) json["width_m"] = metres(c.width_m);
  if (c.row != 0) json["row"] = c.row;
  if (c.kind == CorrectionKind::kRenumber) json["position"] = c.position;
  if (c.kind == CorrectionKind::kRowName) json["name"] = c.name;
  if (!c.note.empty()) json["note"] = c.note;
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

StoredCorrections parse_corrections(std::string_view text, const std::string& name) {
  StoredCorrections stored;
  std::size_t begin = 0;
  for (int line = 1; begin < text.size(); ++line) {
    const std::size_t end = text.find('\n', begin);
    if (end == std::string_view::npos) break;
    const std::string place = name + ":" + std::to_string(line);
    if (end - begin > kLineMax_bytes) throw FileError(place + ": the line is too long");
    Line fields(text.substr(begin, end - begin), place);
    Correction c = correction_of(fields);
    const std::int32_t last = stored.list.empty() ? 0 : stored.list.back().number;
    if (c.number <= last) fields.fail("n must increase from line to line");
    stored.list.push_back(std::move(c));
    begin = end + 1;
  }
  stored.num_unfinished_bytes = text.size() - begin;
  return stored;
}

}  // namespace orchard::io
