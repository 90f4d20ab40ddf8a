// SPDX-License-Identifier: BSD-3-Clause
#include "io/map/corrected_map.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <utility>

#include "detection/detection.hpp"
#include "io/file_error.hpp"
#include "io/map/corrections_file.hpp"
#include "mapping/rows/navigation_graph.hpp"
#include "mapping/rows/row_numbers.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

bool has_moved(const mapping::Landmark& before, const mapping::Landmark& now) {
  return before.x_m != now.x_m || before.y_m != now.y_m;
}

struct RowAndTree {
  std::int32_t row = 0, position = 0;
};

RowAndTree row_and_tree(const CorrectedMapFolder& map, const std::string& name) {
  const std::size_t slash = name.rfind('/');
  const auto position = whole_number(name.substr(slash + 1));
  if (slash == std::string::npos || !position || *position < 1) {
    throw FileError("\"" + name + "\" is not a tree; give an id (17) or row/tree (3/14)");
  }
  return {row_named(map, name.substr(0, slash)), *position};
}

}  // namespace

CorrectedMapFolder corrected_map_of(StoredMap mapped,
                                    std::vector<mapping::Correction> corrections) {
  CorrectedMapFolder folder;
  folder.mapped = std::move(mapped);
  folder.corrections = std::move(corrections);
  folder.corrected = mapping::apply_corrections(
      folder.mapped.landmarks, folder.mapped.next_id, folder.corrections,
      mapping::plan_row_names(folder.mapped.landmarks, folder.mapped.plan_names));
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

std::int32_t row_named(const CorrectedMapFolder& map, const std::string& name) {
  for (const auto& [row, row_name] : map.corrected.row_names) {
    if (row_name == name) return row;
  }
  const auto number = whole_number(name);
  const auto& landmarks = map.corrected.landmarks;
  const bool is_there = number && *number > 0 &&
                        std::any_of(landmarks.begin(), landmarks.end(),
                                    [&](const mapping::Landmark& l) { return l.row == *number; });
  if (!is_there) throw FileError(map.mapped.name + " has no row \"" + name + "\"");
  return *number;
}

const mapping::Landmark& landmark_named(const CorrectedMapFolder& map, const std::string& name) {
  const auto& landmarks = map.corrected.landmarks;
  if (const auto id = whole_number(name)) {
    const auto found = std::find_if(landmarks.begin(), landmarks.end(),
                                    [&](const mapping::Landmark& l) { return l.id == *id; });
    if (found != landmarks.end()) return *found;
    throw FileError(map.mapped.name + " has no landmark " + name +
                    ", or it was deleted (`orchard edit list MAP`)");
  }
  const RowAndTree number = row_and_tree(map, name);
  const auto found = std::find_if(landmarks.begin(), landmarks.end(), [&](const auto& l) {
    return l.row == number.row && l.position == number.position;
  });
  if (found != landmarks.end()) return *found;
  throw FileError(map.mapped.name + " has no tree " + std::to_string(number.position) + " in row " +
                  std::to_string(number.row));
}

Eigen::Vector2d gap_named(const CorrectedMapFolder& map, const std::string& name) {
  const RowAndTree number = row_and_tree(map, name);
  for (const mapping::Row& row : map.rows) {
    if (row.number != number.row) continue;
    for (const mapping::RowSlot& place : row.places) {
      if (place.position == number.position && place.landmark_id == 0) return place.p_map;
    }
  }
  throw FileError(map.mapped.name + " has no gap at tree " + std::to_string(number.position) +
                  " of row " + std::to_string(number.row) + "; give the position with --at X Y");
}

std::string landmark_words(const mapping::Landmark& landmark) {
  std::string words = std::to_string(landmark.id) + " (" + label_text(landmark.label);
  if (landmark.row != 0) words += ", row " + std::to_string(landmark.row);
  if (landmark.position != 0) words += " tree " + std::to_string(landmark.position);
  return words + ")";
}

}  // namespace orchard::io
