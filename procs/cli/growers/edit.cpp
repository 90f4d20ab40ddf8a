// SPDX-License-Identifier: BSD-3-Clause
#include "cli/maps/maps.hpp"

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <unordered_set>

#include "bus/process/process.hpp"
#include "cli/maps/stored_maps.hpp"
#include "detection/detection.hpp"
#include "io/file_error.hpp"
#include "io/gis/background.hpp"
#include "io/gis/edited_map_file.hpp"
#include "io/map/background_file.hpp"
#include "io/map/corrected_map.hpp"
#include "io/map/corrections_file.hpp"
#include "mapping/corrections/apply_corrections.hpp"
#include "text/encoded_text.hpp"
#include "text/number_text.hpp"

namespace orchard::cli {
namespace {

io::MapEdit edit_of(const EditOptions& options) {
  io::MapEdit edit = options.edit;
  for (std::size_t i = 0; i + 1 < options.at_m.size(); i += 2) {
    edit.places_map.push_back({options.at_m[i], options.at_m[i + 1]});
  }
  if (edit.who.empty()) edit.who = person();
  return edit;
}

void require_folder(const std::string& folder) {
  if (std::filesystem::is_directory(folder)) return;
  throw io::FileError(
      folder +
      " is not a map folder; corrections are saved in a map folder, so give that, not map.csv");
}

}  // namespace

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
  if (options.edit.kind != CorrectionKind::kUndo && options.edit.kind != CorrectionKind::kRedo) {
    std::printf("  to undo it: `orchard edit undo %s`\n", options.map_folder.c_str());
  }
  return bus::kExitOk;
}

namespace {

using mapping::Correction;
using mapping::CorrectionOutcome;

void print(const io::CorrectedMapFolder& map, bool only_conflicts, bool json) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < map.corrections.size(); ++i) {
    const Correction& c = map.corrections[i];
    const mapping::CorrectionResult& result = map.corrected.results[i];
    if (only_conflicts && result.outcome != CorrectionOutcome::kConflict) continue;
    if (json) {
      auto entry = nlohmann::ordered_json::parse(io::correction_line(c));
      entry["outcome"] = mapping::outcome_word(result.outcome);
      if (!result.reason.empty()) entry["reason"] = result.reason;
      list.push_back(std::move(entry));
      continue;
    }
    const std::string more = (c.note.empty() ? "" : "  " + c.note) +
                             (result.reason.empty() ? "" : "  [" + result.reason + "]");
    std::printf("%4d  %s  %-12s  %-10s  %s%s\n", c.number, io::utc_text(c.utime).c_str(),
                printable_text(c.who).c_str(), mapping::outcome_word(result.outcome),
                printable_text(mapping::correction_words(c)).c_str(), printable_text(more).c_str());
  }
  if (json) std::printf("%s\n", list.dump(1).c_str());
}

}  // namespace

int run_edit_list(const EditOptions& options) {
  const io::CorrectedMapFolder map = io::read_corrected_map(options.map_folder);
  print(map, false, options.json);
  if (!options.json) std::printf("%s\n", io::corrections_text(map.corrected).c_str());
  return bus::kExitOk;
}

int run_edit_check(const EditOptions& options) {
  const io::CorrectedMapFolder map = io::read_corrected_map(options.map_folder);
  print(map, true, options.json);
  if (!options.json) std::printf("%s\n", io::corrections_text(map.corrected).c_str());
  const bool is_sound = map.corrected.count(CorrectionOutcome::kConflict) == 0;
  return is_sound && map.num_unfinished_bytes == 0 ? bus::kExitOk : bus::kExitInput;
}

int run_edit_background(const EditOptions& options) {
  require_folder(options.map_folder);
  const io::StoredMap map = io::read_stored_map(options.map_folder);
  if (!map.georeference) {
    throw io::FileError(options.map_folder +
                        " is not georeferenced, so a picture has no place in it; map a drive with "
                        "GNSS, or give it a plan (`orchard plan`)");
  }
  Eigen::AlignedBox2d box;
  for (const mapping::Landmark& l : map.landmarks) box.extend(Eigen::Vector2d(l.x_m, l.y_m));
  for (const auto& path : map.trajectories) {
    for (const auto& pose : path) box.extend(Eigen::Vector2d(pose.x_m, pose.y_m));
  }
  if (box.isEmpty()) throw io::FileError(options.map_folder + " is an empty map");
  constexpr double kAround_m = 10.0;  // physical: about a headland
  box.extend(box.min() - Eigen::Vector2d::Constant(kAround_m));
  box.extend(box.max() + Eigen::Vector2d::Constant(kAround_m));
  const view::Background background =
      io::background_of(options.picture_path, *map.georeference, box);
  io::set_background(options.map_folder, background);
  std::printf("%s lies under the map on map.html and in `orchard view`, %.0f m by %.0f m\n",
              printable_text(options.picture_path).c_str(), box.sizes().x(), box.sizes().y());
  return bus::kExitOk;
}

int run_edit_apply(const EditOptions& options) {
  require_other_folder(options.out_folder, {options.map_folder});
  const io::CorrectedMapFolder map = io::read_corrected_map(options.map_folder);
  io::StoredMap known = map.mapped;
  known.landmarks = map.corrected.landmarks;
  known.next_id = map.corrected.next_id;
  io::MapFolderContent content = content_of(known);
  content.rows = map.rows;
  content.graph = map.graph;
  content.background = io::read_background(options.map_folder);
  content.summary.source = "corrected";
  content.summary.counts = {{"corrections", static_cast<std::int64_t>(map.corrections.size())}};
  for (const mapping::CorrectionResult& result : map.corrected.results) {
    if (result.outcome != CorrectionOutcome::kConflict) continue;
    content.summary.warnings.push_back("correction " + std::to_string(result.number) +
                                       " conflicts with the map: " + result.reason);
  }
  io::write_map_folder(options.out_folder, content);
  std::printf("%zu landmarks, corrections %s, written to %s\n", content.landmarks.size(),
              io::corrections_text(map.corrected).c_str(), options.out_folder.c_str());
  return bus::kExitOk;
}

namespace {

using mapping::Correction;

/// Rejects a file that lacks most landmarks, such as an export of one row: they were hardly deleted
/// on purpose.
void require_most(const mapping::CorrectedMap& before, const io::EditedMapFile& edited,
                  const ImportEditsOptions& options) {
  if (options.keep_missing) return;
  std::unordered_set<std::int32_t> ids;
  for (const mapping::EditedLandmark& l : edited.map.landmarks) ids.insert(l.id);
  const auto num_there =
      std::count_if(before.landmarks.begin(), before.landmarks.end(),
                    [&ids](const mapping::Landmark& l) { return ids.count(l.id) > 0; });
  const auto total = static_cast<std::ptrdiff_t>(before.landmarks.size());
  if (2 * num_there >= total) return;
  throw io::FileError(options.edited_path + " has only " + std::to_string(num_there) + " of " +
                      std::to_string(total) + " landmarks of " + options.map_folder +
                      "; if it is only a part of the map, use --keep-missing");
}

/// The corrections that the file contained when it was written.
std::vector<Correction> held(const std::vector<Correction>& all, const io::EditedMapFile& edited,
                             const ImportEditsOptions& options) {
  const auto num = static_cast<std::size_t>(edited.num_corrections);
  if (num > all.size()) {
    throw io::FileError(options.edited_path + " has " + std::to_string(num) + " corrections, but " +
                        options.map_folder + " has " + std::to_string(all.size()) +
                        "; give a file that was exported from this map");
  }
  return {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(num)};
}

std::map<std::string, int> counts_of(const std::vector<Correction>& corrections) {
  std::map<std::string, int> counts;
  for (const Correction& c : corrections) ++counts[mapping::correction_word(c.kind)];
  return counts;
}

void print(const ImportEditsOptions& options, const std::vector<Correction>& added,
           const std::vector<std::string>& conflicts, const std::vector<std::string>& left_out) {
  if (options.json) {
    const nlohmann::ordered_json json{{"added", added.size()},
                                      {"counts", counts_of(added)},
                                      {"conflicts", conflicts},
                                      {"left_out", left_out},
                                      {"dry_run", options.dry_run}};
    std::printf("%s\n", json.dump(2).c_str());
    return;
  }
  std::string words;
  for (const auto& [word, num] : counts_of(added)) {
    words += (words.empty() ? "" : ", ") + std::to_string(num) + " " + word;
  }
  std::printf("%zu corrections%s%s%s\n", added.size(), words.empty() ? "" : ": ", words.c_str(),
              options.dry_run ? " (--dry-run: nothing was saved)" : "");
  for (const std::string& sentence : conflicts) std::printf("conflict: %s\n", sentence.c_str());
  for (const std::string& sentence : left_out) std::printf("left out: %s\n", sentence.c_str());
  if (!added.empty() && !options.dry_run) {
    std::printf("  list all corrections with `orchard edit list %s`, undo one with `undo`\n",
                options.map_folder.c_str());
  }
}

}  // namespace

int run_import_edits(const ImportEditsOptions& options) {
  require_folder(options.map_folder);
  if (!io::is_correction_text(options.who)) {
    throw io::FileError("--who: the name is too long or has several lines; give a short name");
  }
  const io::StoredMap mapped = io::read_stored_map(options.map_folder);
  const io::EditedMapFile edited = io::read_edited_map(options.edited_path, mapped.georeference);
  mapping::EditedMapOptions how;
  how.utime = std::int64_t{1000000} * static_cast<std::int64_t>(std::time(nullptr));
  how.who = options.who.empty() ? person() : options.who;
  how.keep_missing = options.keep_missing;
  mapping::EditedMapCorrections found;
  std::vector<std::string> conflicts;
  std::vector<Correction> added;
  const auto make = [&](const std::vector<Correction>& all) {
    // Compare with the row numbers of that time: numbers assigned by position are not edits.
    const mapping::CorrectedMap before =
        io::corrected_map_of(mapped, held(all, edited, options)).corrected;
    require_most(before, edited, options);
    const mapping::CorrectedMap now =
        mapping::apply_corrections(mapped.landmarks, mapped.next_id, all);
    found = mapping::corrections_of(before, edited.map, now.next_id, how);
    for (const Correction& c : found.corrections) {
      if (io::is_correction_text(c.note) && io::is_correction_text(c.name)) continue;
      throw io::FileError(options.edited_path + ": the note or name of " +
                          (c.targets.empty() ? "row " + std::to_string(c.row)
                                             : "landmark " + std::to_string(c.targets.front().id)) +
                          " is too long or has control characters; shorten or correct it");
    }
    conflicts.clear();
    added = mapping::corrections_that_fit(mapped.landmarks, mapped.next_id, all, found.corrections,
                                          conflicts);
    return added;
  };
  if (options.dry_run) {
    make(io::read_corrections(options.map_folder).list);
  } else {
    io::append_corrections(options.map_folder, make);
  }
  found.left_out.insert(found.left_out.end(), edited.left_out.begin(), edited.left_out.end());
  print(options, added, conflicts, found.left_out);
  return conflicts.empty() ? bus::kExitOk : bus::kExitInput;
}

}  // namespace orchard::cli
