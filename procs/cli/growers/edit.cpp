// SPDX-License-Identifier: BSD-3-Clause
#include "cli/growers/edit.hpp"

#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "bus/process/process.hpp"
#include "io/file_error.hpp"
#include "io/map/corrections_file.hpp"
#include "io/map/map_edit.hpp"

namespace orchard::cli {
namespace {

io::MapEdit edit_of(const EditOptions& options) {
  io::MapEdit edit;
  edit.kind = options.kind;
  edit.trees = options.trees;
  if (!options.tree.empty()) edit.trees.push_back(options.tree);
  for (std::size_t i = 0; i + 1 < options.at_m.size(); i += 2) {
    edit.places_map.push_back({options.at_m[i], options.at_m[i + 1]});
  }
  edit.class_word = options.class_word;
  edit.width_m = options.width_m;
  edit.row = options.row;
  edit.name = options.name;
  edit.position = options.position;
  edit.of = options.of;
  edit.who = options.who.empty() ? person() : options.who;
  edit.note = options.note;
  return edit;
}

void require_folder(const std::string& folder) {
  if (std::filesystem::is_directory(folder)) return;
  throw io::FileError(
      folder +
      " is not a map folder; corrections are saved in a map folder, so give that, not map.csv");
}

}  // namespace

std::string person() {
  const char* name = std::getenv("USER");
  if (name == nullptr || *name == '\0') name = std::getenv("LOGNAME");
  const std::string who = name == nullptr ? "" : name;
  return who.empty() || !io::is_correction_text(who) ? "somebody" : who;
}

int run_edit(const EditOptions& options) {
  require_folder(options.map_folder);
  const std::size_t num_unfinished = io::read_corrections(options.map_folder).num_unfinished_bytes;
  if (num_unfinished > 0) {
    std::fprintf(stderr,
                 "orchard edit: warning: the last line of %s is incomplete (an interrupted write); "
                 "its %zu bytes are ignored\n",
                 io::kCorrectionsFile, num_unfinished);
  }
  const io::MapEditEffect effect =
      io::edit_map(options.map_folder, io::read_stored_map(options.map_folder), edit_of(options));
  std::printf("%s\n", effect.words().c_str());
  for (const std::string& sentence : effect.new_conflicts()) {
    std::fprintf(stderr, "orchard edit: warning: %s\n", sentence.c_str());
  }
  using mapping::CorrectionKind;
  if (options.kind != CorrectionKind::kUndo && options.kind != CorrectionKind::kRedo) {
    std::printf("  to undo it: `orchard edit %s undo`\n", options.map_folder.c_str());
  }
  return bus::kExitOk;
}

}  // namespace orchard::cli
