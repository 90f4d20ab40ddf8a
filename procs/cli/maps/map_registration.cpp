// SPDX-License-Identifier: BSD-3-Clause
#include "cli/maps/map_registration.hpp"

#include <algorithm>
#include <filesystem>

#include "io/file_error.hpp"
#include "mapping/corrections/apply_corrections.hpp"
#include "mapping/rows/row_numbers.hpp"

namespace orchard::cli {

mapping::DetectionMap view_of(const io::StoredMap& map, double reach_m) {
  mapping::SensorView view = map.view;
  if (reach_m > 0.0) view.reach_m = reach_m;
  return mapping::DetectionMap(map.landmarks, map.trajectories, view);
}

mapping::MapAlignment register_map(const io::StoredMap& a, const mapping::DetectionMap& view_a,
                                   const io::StoredMap& b, const mapping::DetectionMap& view_b,
                                   const mapping::MapAlignmentConfig& config) {
  mapping::MapAlignment alignment =
      mapping::align_maps(a.landmarks, b.landmarks, view_a, view_b, config);
  switch (alignment.status) {
    case mapping::AlignmentStatus::kAligned:
      break;
    case mapping::AlignmentStatus::kAmbiguous:
      throw io::FileError(
          b.name + " cannot be aligned with " + a.name +
          ", the result is ambiguous: " + alignment.reason +
          "; if the frames of both maps differ by less, set a smaller --max-offset");
    case mapping::AlignmentStatus::kNone:
      throw io::FileError(
          b.name + " cannot be aligned with " + a.name + ": " + alignment.reason +
          (config.any_place
               ? "; are both maps of one orchard?"
               : "; are both maps of one orchard? If their frames are unrelated, use --any-place"));
  }
  return alignment;
}

EarlierIdentity transfer_identity(const io::CorrectedMapFolder& earlier,
                                  const mapping::MapAlignmentConfig& config,
                                  io::MapFolderContent& content) {
  io::StoredMap known = earlier.mapped;
  known.landmarks = mapping::known_landmarks(known.landmarks, earlier.corrected.landmarks);
  known.next_id = std::max(known.next_id, earlier.corrected.next_id);
  io::StoredMap now;
  now.name = "the new map";
  now.landmarks = content.landmarks;
  if (!content.trajectory.empty()) now.trajectories = {content.trajectory};
  now.trajectories.insert(now.trajectories.end(), content.more_trajectories.begin(),
                          content.more_trajectories.end());
  if (content.view) now.view = *content.view;
  const mapping::MapAlignment alignment =
      register_map(known, view_of(known, 0.0), now, view_of(now, 0.0), config);
  content.next_id = known.next_id;
  EarlierIdentity kept;
  kept.numbers = mapping::keep_ids(known.landmarks, alignment, content.next_id, content.landmarks);
  mapping::keep_numbers(known.landmarks, mapping::numbered_rows(content.landmarks),
                        content.landmarks, kept.numbers);
  kept.corrections = mapping::carry_corrections(earlier.corrections, known.landmarks,
                                                content.landmarks, alignment.T_a_b);
  content.summary.counts.push_back({"kept_ids", kept.numbers.num_found});
  content.summary.counts.push_back({"gone_ids", kept.numbers.num_gone});
  content.summary.counts.push_back({"new_ids", kept.numbers.num_new});
  if (kept.numbers.num_without_number > 0) {
    content.summary.warnings.push_back(
        std::to_string(kept.numbers.num_without_number) +
        " new trees got a row but no position: at their places no number of the row is free");
  }
  return kept;
}

void require_other_folder(const std::string& out_folder, const std::vector<std::string>& inputs) {
  namespace fs = std::filesystem;
  for (const std::string& input : inputs) {
    fs::path folder(input);
    if (!fs::is_directory(folder)) folder = folder.parent_path();
    if (folder.empty()) folder = ".";
    std::error_code error;
    if (fs::equivalent(folder, out_folder, error)) {
      throw io::FileError(
          out_folder + " is the folder of the map " + input +
          ", an input that must not be overwritten; choose another folder with --out");
    }
  }
}

}  // namespace orchard::cli
