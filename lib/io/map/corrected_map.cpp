// SPDX-License-Identifier: BSD-3-Clause
#include "io/map/corrected_map.hpp"

#include <filesystem>
#include <map>
#include <utility>

#include "io/map/corrections_file.hpp"
#include "mapping/rows/navigation_graph.hpp"
#include "mapping/rows/row_numbers.hpp"

namespace orchard::io {
namespace {

bool has_moved(const mapping::Landmark& before, const mapping::Landmark& now) {
  return before.x_m != now.x_m || before.y_m != now.y_m;
}

}  // namespace

CorrectedMapFolder corrected_map_of(StoredMap mapped,
                                    std::vector<mapping::Correction> corrections) {
  CorrectedMapFolder folder;
  folder.mapped = std::move(mapped);
  folder.corrections = std::move(corrections);
  folder.corrected = mapping::apply_corrections(folder.mapped.landmarks, folder.mapped.next_id,
                                                folder.corrections);
  std::map<std::int32_t, const mapping::Landmark*> as_mapped;
  for (const mapping::Landmark& l : folder.mapped.landmarks) as_mapped[l.id] = &l;
  const auto was = [&](const mapping::Landmark& l) {
    const auto found = as_mapped.find(l.id);
    return found == as_mapped.end() ? nullptr : found->second;
  };
  mapping::number_added_trees(folder.corrected.landmarks, [&](const mapping::Landmark& l) {
    const mapping::Landmark* before = was(l);
    return before == nullptr || before->label != l.label || has_moved(*before, l);
  });
  folder.rows = mapping::numbered_rows(folder.corrected.landmarks);
  std::vector<mapping::Landmark> obstacles;
  for (const mapping::Landmark& l : folder.corrected.landmarks) {
    const mapping::Landmark* before = was(l);
    if (before == nullptr || has_moved(*before, l)) obstacles.push_back(l);
  }
  folder.graph = mapping::narrowed(folder.mapped.graph, obstacles);
  return folder;
}

CorrectedMapFolder read_corrected_map(const std::string& folder_or_csv, bool as_mapped) {
  StoredMap mapped = read_stored_map(folder_or_csv);
  if (as_mapped || !std::filesystem::is_directory(folder_or_csv)) {
    return corrected_map_of(std::move(mapped), {});
  }
  StoredCorrections stored = read_corrections(folder_or_csv);
  CorrectedMapFolder folder = corrected_map_of(std::move(mapped), std::move(stored.list));
  folder.num_unfinished_bytes = stored.num_unfinished_bytes;
  return folder;
}

std::string corrections_text(const mapping::CorrectedMap& corrected) {
  using mapping::CorrectionOutcome;
  const std::pair<CorrectionOutcome, const char*> kWords[] = {
      {CorrectionOutcome::kApplied, "applied"},
      {CorrectionOutcome::kByPlace, "applied by place"},
      {CorrectionOutcome::kSatisfied, "already so"},
      {CorrectionOutcome::kUndone, "undone"},
      {CorrectionOutcome::kConflict, "in conflict"}};
  std::string text;
  for (const auto& [outcome, word] : kWords) {
    const int count = corrected.count(outcome);
    if (count == 0) continue;
    text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + word;
  }
  return text.empty() ? "none" : text;
}

}  // namespace orchard::io
