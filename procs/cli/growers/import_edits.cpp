// SPDX-License-Identifier: BSD-3-Clause
#include "cli/growers/import_edits.hpp"

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <unordered_set>

#include "bus/process/process.hpp"
#include "cli/growers/edit.hpp"
#include "io/file_error.hpp"
#include "io/gis/edited_map_file.hpp"
#include "io/map/corrected_map.hpp"
#include "io/map/corrections_file.hpp"

namespace orchard::cli {
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
    std::printf("  list all corrections with `orchard edit %s list`, undo one with `undo`\n",
                options.map_folder.c_str());
  }
}

}  // namespace

int run_import_edits(const ImportEditsOptions& options) {
  if (!std::filesystem::is_directory(options.map_folder)) {
    throw io::FileError(options.map_folder +
                        " is not a map folder; corrections are saved in a map folder");
  }
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
