// SPDX-License-Identifier: BSD-3-Clause
#include "io/map/map_edit.hpp"

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <utility>

#include "detection/detection.hpp"
#include "io/file_error.hpp"
#include "io/map/corrected_map.hpp"
#include "io/map/corrections_file.hpp"
#include "io/sane_limits.hpp"
#include "text/encoded_text.hpp"

namespace orchard::io {
namespace {

using Eigen::Vector2d;
using mapping::Correction;
using mapping::CorrectionKind;
using mapping::CorrectionOutcome;
using mapping::CorrectionTarget;
using mapping::Landmark;

detection::Label label_named(const std::string& word) {
  for (const auto label : {detection::Label::kTree, detection::Label::kObject}) {
    if (word == label_text(label)) return label;
  }
  throw FileError("\"" + word + "\" is not a class; give tree or object");
}

constexpr int kPositionMax = 1000000;

CorrectionTarget target_of(const Landmark& l) { return {l.id, {l.x_m, l.y_m}, l.label, l.width_m}; }

/// Weighted mean position of the landmarks to merge.
Vector2d place_of_all(const CorrectedMapFolder& map, const std::vector<std::string>& trees) {
  Vector2d sum(0, 0);
  double num = 0.0;
  for (const std::string& tree : trees) {
    const Landmark& l = landmark_named(map, tree);
    const double n = std::max(1, l.num_observations);
    sum += n * Vector2d(l.x_m, l.y_m);
    num += n;
  }
  return sum / num;
}

/// Number of the correction to undo or redo.
std::int32_t number_to_turn(const MapEdit& edit, const std::vector<Correction>& corrections) {
  const bool undoes = edit.kind == CorrectionKind::kUndo;
  if (edit.of == 0) {
    const std::int32_t last =
        undoes ? mapping::last_to_undo(corrections) : mapping::last_to_redo(corrections);
    if (last == 0) throw FileError(undoes ? "nothing to undo" : "nothing to redo");
    return last;
  }
  const std::vector<bool> holds = mapping::corrections_that_hold(corrections);
  for (std::size_t i = 0; i < corrections.size(); ++i) {
    const Correction& c = corrections[i];
    const bool is_step = c.kind == CorrectionKind::kUndo || c.kind == CorrectionKind::kRedo;
    if (c.number != edit.of || is_step) continue;
    if (holds[i] == undoes) return c.number;
    throw FileError("correction " + std::to_string(c.number) +
                    (undoes ? " is undone already" : " is applied already"));
  }
  throw FileError("no correction has number " + std::to_string(edit.of) +
                  "; list them with `orchard edit list MAP`");
}

/// Number of a row; a row without trees is new.
std::int32_t row_to_give(const std::string& name, const CorrectedMapFolder& map) {
  const int number = std::atoi(name.c_str());
  const bool is_number = number > 0 && number < 1000000 && std::to_string(number) == name;
  return is_number ? number : row_named(map, name);
}

Correction correction_of(const MapEdit& edit, const CorrectedMapFolder& map) {
  Correction c;
  c.kind = edit.kind;
  c.number = map.corrections.empty() ? 1 : map.corrections.back().number + 1;
  c.utime = std::int64_t{1000000} * static_cast<std::int64_t>(std::time(nullptr));
  c.who = edit.who;
  c.note = edit.note;
  if (c.kind != CorrectionKind::kAdd) {
    for (const std::string& tree : edit.trees) {
      c.targets.push_back(target_of(landmark_named(map, tree)));
    }
  }
  c.places_map = edit.places_map;
  if (c.kind == CorrectionKind::kAdd) {
    if (c.places_map.empty() == edit.trees.empty()) {
      throw FileError("give the position of the missing landmark: a gap (3/14) or --at X Y");
    }
    if (c.places_map.empty()) c.places_map = {gap_named(map, edit.trees.front())};
  }
  if (c.kind == CorrectionKind::kMerge && c.places_map.empty()) {
    c.places_map = {place_of_all(map, edit.trees)};
  }
  const CorrectionShape& shape = correction_shape(c.kind);
  if (shape.has("new_id")) c.new_id = map.corrected.next_id;
  if (shape.has("class")) c.label = label_named(edit.class_word);
  if (shape.has("width_m")) c.width_m = edit.width_m;
  if (shape.has("name")) c.row = row_named(map, edit.row), c.name = edit.name;
  if (shape.has("position")) c.row = row_to_give(edit.row, map), c.position = edit.position;
  if (shape.has("of")) c.of = number_to_turn(edit, map.corrections);
  return c;
}

/// Throws FileError if the correction cannot be applied to the map.
void require_possible(const Correction& c, const CorrectedMapFolder& after) {
  const mapping::CorrectionResult& result = after.corrected.results.back();
  if (result.outcome == CorrectionOutcome::kConflict) throw FileError(result.reason);
  if (result.outcome == CorrectionOutcome::kSatisfied) {
    throw FileError("nothing to correct: " + result.reason);
  }
  if (c.kind == CorrectionKind::kSplit && (c.places_map[0] - c.places_map[1]).norm() < 0.01) {
    throw FileError("the two positions are equal; give two different ones with --at X1 Y1 X2 Y2");
  }
}

/// Checks the number of trees and positions for the kind, and that the texts can be stored. Input
/// from a page is not trusted.
void require_sound(const MapEdit& edit) {
  for (const std::string* text : {&edit.who, &edit.note, &edit.name}) {
    if (!is_correction_text(*text)) {
      throw FileError(
          "the text is too long, not UTF-8 or has several lines; shorten or correct it");
    }
  }
  const CorrectionShape& shape = correction_shape(edit.kind);
  const bool is_add = edit.kind == CorrectionKind::kAdd;  // of a gap, or at a place
  const bool may_lack_place = is_add || edit.kind == CorrectionKind::kMerge;
  const auto require_number = [&](std::size_t num, std::size_t least, std::size_t most,
                                  const char* what) {
    if (num >= least && num <= most) return;
    throw FileError(mapping::correction_word(edit.kind) + (" needs " + std::to_string(least)) +
                    " to " + std::to_string(most) + what + ", not " + std::to_string(num));
  };
  require_number(edit.trees.size(), shape.trees_least, is_add ? 1 : shape.trees_most, " trees");
  require_number(edit.places_map.size(), may_lack_place ? 0 : shape.num_places, shape.num_places,
                 " places");
  for (const Vector2d& p : edit.places_map) {
    if (!(p.cwiseAbs().maxCoeff() <= kMaxCoordinate_m)) {
      throw FileError("the position is farther away than a map can reach");
    }
  }
  if (edit.position < 0 || edit.position > kPositionMax || edit.of < 0 ||
      !(edit.width_m >= 0.0 && edit.width_m <= kMaxWidth_m)) {
    throw FileError("a number is out of range");
  }
  if (edit.kind == CorrectionKind::kNote && edit.note.empty()) {
    throw FileError("the note is empty");
  }
}

}  // namespace

std::vector<std::string> MapEditEffect::new_conflicts() const {
  std::vector<std::string> sentences;
  for (std::size_t i = 0; i < before.corrections.size(); ++i) {
    const auto& was = before.corrected.results[i];
    const auto& is = after.corrected.results[i];
    if (is.outcome != CorrectionOutcome::kConflict || was.outcome == is.outcome) continue;
    sentences.push_back("correction " + std::to_string(is.number) + " (" +
                        mapping::correction_word(before.corrections[i].kind) +
                        ") now conflicts with the map: " + is.reason);
  }
  return sentences;
}

std::string MapEditEffect::words() const {
  const Correction& c = correction;
  std::string what;
  for (const CorrectionTarget& target : c.targets) {
    what += (what.empty() ? " " : " and ") + std::to_string(target.id);
  }
  if (c.new_id != 0) what += (what.empty() ? " " : ", new ") + std::to_string(c.new_id);
  if (c.of != 0) what += " " + std::to_string(c.of);
  if (c.kind == CorrectionKind::kRowName) what += " " + std::to_string(c.row) + ": " + c.name;
  for (const Landmark& l : after.corrected.landmarks) {
    if (l.id == c.new_id && l.row != 0) what += ", " + landmark_words(l);
  }
  return "correction " + std::to_string(c.number) + ": " + mapping::correction_word(c.kind) +
         printable_text(what);
}

MapEditEffect edit_map(const std::string& folder, const StoredMap& mapped, const MapEdit& edit) {
  require_sound(edit);
  MapEditEffect effect;
  const auto added = append_corrections(folder, [&](const std::vector<Correction>& corrections) {
    effect.before = corrected_map_of(mapped, corrections);
    const Correction c = correction_of(edit, effect.before);
    std::vector<Correction> with = corrections;
    with.push_back(c);
    effect.after = corrected_map_of(mapped, std::move(with));
    require_possible(c, effect.after);
    return std::vector<Correction>{c};
  });
  effect.correction = added.front();
  return effect;
}

}  // namespace orchard::io
