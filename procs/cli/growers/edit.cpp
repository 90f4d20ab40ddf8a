// SPDX-License-Identifier: BSD-3-Clause
#include "cli/growers/edit.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>

#include "bus/node/process.hpp"
#include "cli/growers/tree_name.hpp"
#include "detection/label_text.hpp"
#include "io/file_error.hpp"
#include "io/map/corrections_file.hpp"
#include "text/number_text.hpp"
#include "text/printable_text.hpp"

namespace orchard::cli {
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
  throw io::FileError("\"" + word + "\" is no class; give tree or object");
}

CorrectionTarget target_of(const Landmark& l) { return {l.id, {l.x_m, l.y_m}, l.label, l.width_m}; }

std::vector<Vector2d> places_of(const EditOptions& options) {
  std::vector<Vector2d> places;
  for (std::size_t i = 0; i + 1 < options.at_m.size(); i += 2) {
    places.push_back({options.at_m[i], options.at_m[i + 1]});
  }
  return places;
}

/// Two looks at one thing: the better known one says where it stands.
Vector2d place_of_all(const io::CorrectedMapFolder& map, const std::vector<std::string>& trees) {
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

/// The number that undo or redo means.
std::int32_t number_to_turn(const EditOptions& options,
                            const std::vector<Correction>& corrections) {
  const bool undoes = options.kind == CorrectionKind::kUndo;
  if (options.of == 0) {
    const std::int32_t last =
        undoes ? mapping::last_to_undo(corrections) : mapping::last_to_redo(corrections);
    if (last == 0) throw io::FileError(undoes ? "nothing to undo" : "nothing to redo");
    return last;
  }
  const std::vector<bool> holds = mapping::corrections_that_hold(corrections);
  for (std::size_t i = 0; i < corrections.size(); ++i) {
    const Correction& c = corrections[i];
    const bool is_step = c.kind == CorrectionKind::kUndo || c.kind == CorrectionKind::kRedo;
    if (c.number != options.of || is_step) continue;
    if (holds[i] == undoes) return c.number;
    throw io::FileError("correction " + std::to_string(c.number) +
                        (undoes ? " is undone already" : " holds already"));
  }
  throw io::FileError("there is no correction " + std::to_string(options.of) +
                      " (`orchard edit MAP list`)");
}

/// A row's number; one that has no tree yet is new.
std::int32_t row_to_give(const std::string& name, const io::CorrectedMapFolder& map) {
  const int number = std::atoi(name.c_str());
  const bool is_number = number > 0 && number < 1000000 && std::to_string(number) == name;
  return is_number ? number : row_named(map, name);
}

Correction correction_of(const EditOptions& options, const io::CorrectedMapFolder& map) {
  Correction c;
  c.kind = options.kind;
  c.number = map.corrections.empty() ? 1 : map.corrections.back().number + 1;
  c.utime = std::int64_t{1000000} * static_cast<std::int64_t>(std::time(nullptr));
  c.who = options.who.empty() ? person() : options.who;
  c.note = options.note;
  std::vector<std::string> trees = options.trees;
  if (!options.tree.empty() && c.kind != CorrectionKind::kAdd) trees.push_back(options.tree);
  for (const std::string& tree : trees) c.targets.push_back(target_of(landmark_named(map, tree)));
  c.places_map = places_of(options);
  switch (c.kind) {
    case CorrectionKind::kAdd:
      if (c.places_map.empty() == options.tree.empty()) {
        throw io::FileError("give the place of what is missing: a gap (3/14) or --at X Y");
      }
      if (c.places_map.empty()) c.places_map = {gap_named(map, options.tree)};
      c.new_id = map.corrected.next_id;
      c.label = label_named(options.class_word);
      c.width_m = options.width_m;
      break;
    case CorrectionKind::kClass:
      c.label = label_named(options.class_word);
      break;
    case CorrectionKind::kMerge:
      if (c.places_map.empty()) c.places_map = {place_of_all(map, options.trees)};
      break;
    case CorrectionKind::kSplit:
      c.new_id = map.corrected.next_id;
      break;
    case CorrectionKind::kRowName:
      c.row = row_named(map, options.row);
      c.name = options.name;
      break;
    case CorrectionKind::kRenumber:
      c.row = row_to_give(options.row, map);
      c.position = options.position;
      break;
    case CorrectionKind::kUndo:
    case CorrectionKind::kRedo:
      c.of = number_to_turn(options, map.corrections);
      break;
    default:
      break;
  }
  return c;
}

/// Throws where the map would not take it.
void require_possible(const Correction& c, const io::CorrectedMapFolder& after) {
  const mapping::CorrectionResult& result = after.corrected.results.back();
  if (result.outcome == CorrectionOutcome::kConflict) throw io::FileError(result.reason);
  if (result.outcome == CorrectionOutcome::kSatisfied) {
    throw io::FileError("nothing to correct: " + result.reason);
  }
  if (c.kind == CorrectionKind::kSplit && (c.places_map[0] - c.places_map[1]).norm() < 0.01) {
    throw io::FileError("the two parts stand in one place; give two with --at X1 Y1 X2 Y2");
  }
}

/// What a correction did, and what it left in conflict.
void print_effect(const EditOptions& options, const Correction& c,
                  const io::CorrectedMapFolder& before, const io::CorrectedMapFolder& after) {
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
  std::printf("correction %d: %s%s\n", c.number, mapping::correction_word(c.kind),
              printable_text(what).c_str());
  for (std::size_t i = 0; i < before.corrections.size(); ++i) {
    const auto& was = before.corrected.results[i];
    const auto& is = after.corrected.results[i];
    if (is.outcome != CorrectionOutcome::kConflict || was.outcome == is.outcome) continue;
    std::fprintf(stderr, "orchard edit: warning: correction %d (%s) is in conflict now: %s\n",
                 is.number, mapping::correction_word(before.corrections[i].kind),
                 is.reason.c_str());
  }
  if (c.kind != CorrectionKind::kUndo && c.kind != CorrectionKind::kRedo) {
    std::printf("  `orchard edit %s undo` takes it back\n", options.map_folder.c_str());
  }
}

}  // namespace

std::string person() {
  const char* name = std::getenv("USER");
  if (name == nullptr || *name == '\0') name = std::getenv("LOGNAME");
  const std::string who = name == nullptr ? "" : name;
  return who.empty() || !io::is_correction_text(who) ? "somebody" : who;
}

int run_edit(const EditOptions& options) {
  if (!std::filesystem::is_directory(options.map_folder)) {
    throw io::FileError(options.map_folder +
                        " is no map folder; corrections need one to stand in (not map.csv alone)");
  }
  for (const std::string* text : {&options.who, &options.note, &options.name}) {
    if (!io::is_correction_text(*text)) {
      throw io::FileError("a text that is too long, no UTF-8 or of several lines cannot be noted");
    }
  }
  const std::size_t num_unfinished = io::read_corrections(options.map_folder).num_unfinished_bytes;
  if (num_unfinished > 0) {
    std::fprintf(stderr,
                 "orchard edit: warning: the end of %s was never written whole; %zu bytes are left "
                 "out\n",
                 io::kCorrectionsFile, num_unfinished);
  }
  const io::StoredMap mapped = io::read_stored_map(options.map_folder);
  io::CorrectedMapFolder before, after;
  const auto added =
      io::append_corrections(options.map_folder, [&](const std::vector<Correction>& corrections) {
        before = io::corrected_map_of(mapped, corrections);
        const Correction c = correction_of(options, before);
        std::vector<Correction> with = corrections;
        with.push_back(c);
        after = io::corrected_map_of(mapped, std::move(with));
        require_possible(c, after);
        return std::vector<Correction>{c};
      });
  print_effect(options, added.front(), before, after);
  return bus::kExitOk;
}

}  // namespace orchard::cli
