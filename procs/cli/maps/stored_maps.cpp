// SPDX-License-Identifier: BSD-3-Clause
#include "cli/maps/stored_maps.hpp"

#include <pwd.h>
#include <unistd.h>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <memory>
#include <utility>

#include "bus/messages/channel.hpp"
#include "geometry/point_grid.hpp"
#include "io/atomic_file.hpp"
#include "io/file_error.hpp"
#include "io/map/corrected_map.hpp"
#include "io/map/corrections_file.hpp"
#include "mapping/corrections/apply_corrections.hpp"
#include "mapping/rows/row_numbers.hpp"
#include "text/encoded_text.hpp"

namespace orchard::cli {

void warn_of_conflicts(const char* command, const std::string& path,
                       const mapping::CorrectedMap& corrected) {
  const int num_conflicts = corrected.count(mapping::CorrectionOutcome::kConflict);
  if (num_conflicts == 0) return;
  std::fprintf(stderr,
               "%s: warning: %d corrections conflict with the map and are not applied; list them "
               "with `orchard edit check %s`\n",
               command, num_conflicts, path.c_str());
}

MapInput read_map_input(const char* command, const std::string& path, bool as_mapped) {
  io::CorrectedMapFolder folder = io::read_corrected_map(path, as_mapped);
  warn_of_conflicts(command, path, folder.corrected);
  auto trajectories = std::move(folder.mapped.trajectories);  // large: not held twice
  MapInput input{folder.mapped, std::move(folder.mapped), folder.corrected.row_names};
  input.mapped.trajectories = std::move(trajectories);
  input.map.landmarks = folder.corrected.landmarks;
  input.map.next_id = folder.corrected.next_id;
  return input;
}

std::filesystem::path map_folder_of(const std::string& map_path) {
  namespace fs = std::filesystem;
  fs::path folder = fs::absolute(map_path).lexically_normal();
  if (!fs::is_directory(folder)) folder = folder.parent_path();
  return folder.has_filename() ? folder : folder.parent_path();
}

std::string map_name(const std::string& map_path) {
  return printable_text(map_folder_of(map_path).filename().string());
}

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
  for (const mapping::Landmark& l : content.landmarks) {
    const auto name = known.plan_names.find(l.id);
    if (name != known.plan_names.end()) content.plan_names.insert(*name);
  }
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

namespace {

using mapping::Correction;
using mapping::CorrectionOutcome;

bool are_the_same(const Correction& a, const Correction& b) {
  return a.number == b.number && a.utime == b.utime && a.who == b.who && a.kind == b.kind &&
         a.note == b.note;
}

}  // namespace

void require_corrections_of(const std::string& out_folder, const io::CorrectedMapFolder& earlier) {
  for (const Correction& c : io::read_corrections(out_folder).list) {
    const bool is_known =
        std::any_of(earlier.corrections.begin(), earlier.corrections.end(),
                    [&](const Correction& known) { return are_the_same(known, c); });
    if (is_known) continue;
    throw io::FileError(out_folder + "/" + io::kCorrectionsFile + " has correction " +
                        std::to_string(c.number) + " by " + c.who + ", which is not in the map " +
                        earlier.mapped.name + "; choose another folder with --out");
  }
}

std::string account_corrections(const char* command, const std::vector<Correction>& corrections,
                                io::MapFolderContent& content) {
  if (corrections.empty()) return {};
  const mapping::CorrectedMap corrected =
      mapping::apply_corrections(content.landmarks, content.next_id, corrections);
  content.next_id = std::max(content.next_id, corrected.next_id);
  const auto count = [&](const char* name, CorrectionOutcome outcome) {
    content.summary.counts.push_back({kCorrectionCount + name, corrected.count(outcome)});
  };
  count("applied", CorrectionOutcome::kApplied);
  count("by_place", CorrectionOutcome::kByPlace);
  count("already_so", CorrectionOutcome::kSatisfied);
  count("in_conflict", CorrectionOutcome::kConflict);
  for (std::size_t i = 0; i < corrections.size(); ++i) {
    if (corrected.results[i].outcome != CorrectionOutcome::kConflict) continue;
    const Correction& c = corrections[i];
    content.summary.warnings.push_back("correction " + std::to_string(c.number) + " (" +
                                       mapping::correction_word(c.kind) + ", by " + c.who +
                                       ") conflicts with the map: " + corrected.results[i].reason);
    std::fprintf(stderr, "%s: warning: %s\n", command, content.summary.warnings.back().c_str());
  }
  return io::corrections_text(corrected);
}

void write_corrections(const std::string& folder, const std::vector<Correction>& corrections) {
  const std::string path = folder + "/" + io::kCorrectionsFile;
  if (corrections.empty()) return;
  std::string text;
  for (const Correction& c : corrections) text += io::correction_line(c);
  io::write_file_atomically(path, text);
}

mapping::FreeSpaceTest seen_free_of(const io::StoredMap& map) {
  constexpr double kBeside_m = 1.0;
  if (map.trajectories.empty()) return {};
  std::vector<Eigen::Vector2d> path;
  for (const auto& trajectory : map.trajectories) {
    for (const pose::PoseEstimate& pose : trajectory) path.push_back({pose.x_m, pose.y_m});
  }
  const auto points = std::make_shared<geometry::IndexedPoints>(std::move(path));
  return [points](const Eigen::Vector2d& p) { return points->nearest(p, kBeside_m) >= 0; };
}

io::MapSummary summary_of(const io::StoredMap& map) {
  io::MapSummary summary;
  summary.version = ORCHARD_VERSION;
  if (map.trajectories.empty()) return summary;
  summary.first_utime = map.trajectories.front().front().utime;
  for (const auto& trajectory : map.trajectories) {
    summary.first_utime = std::min(summary.first_utime, trajectory.front().utime);
    summary.last_utime = std::max(summary.last_utime, trajectory.back().utime);
  }
  return summary;
}

io::MapFolderContent content_of(io::StoredMap map) {
  io::MapFolderContent content;
  content.summary = summary_of(map);
  content.landmarks = std::move(map.landmarks);
  content.next_id = map.next_id;
  content.georeference = map.georeference;
  content.view = map.view;
  content.graph = std::move(map.graph);
  content.plan_names = std::move(map.plan_names);
  if (map.trajectories.empty()) return content;
  content.trajectory = std::move(map.trajectories.front());
  content.more_trajectories.assign(std::make_move_iterator(map.trajectories.begin() + 1),
                                   std::make_move_iterator(map.trajectories.end()));
  return content;
}

io::SummaryFacts facts_of(const std::string& map_path) {
  const auto count_of = [](bus::Channel channel) {
    return "in_" + std::string(bus::info(channel).name);
  };
  return io::read_summary_facts(map_path, bus::info(bus::Channel::kGnss).name,
                                count_of(bus::Channel::kScan), count_of(bus::Channel::kImage));
}

mapping::MapAlignment register_map(const MapInput& a, const mapping::DetectionMap& view_a,
                                   const MapInput& b, const mapping::DetectionMap& view_b,
                                   const mapping::MapAlignmentConfig& config) {
  mapping::MapAlignment alignment = register_map(a.mapped, view_a, b.mapped, view_b, config);
  alignment.pairs = mapping::pairs_in(alignment.pairs, a.mapped.landmarks, b.mapped.landmarks,
                                      a.map.landmarks, b.map.landmarks);
  return alignment;
}

ComparedMaps compare_with_earlier(const char* command, const std::string& previous_path,
                                  const std::string& map_path, const MapInput& now, bool as_mapped,
                                  const mapping::MapAlignmentConfig& config) {
  ComparedMaps compared{read_map_input(command, previous_path, as_mapped), {}};
  for (const auto& [map, path] : {std::pair(&std::as_const(compared.before.mapped), &previous_path),
                                  std::pair(&now.mapped, &map_path)}) {
    if (!map->trajectories.empty()) continue;
    throw io::FileError(*path +
                        " has no trajectory.csv beside it, so trees that were not observed cannot "
                        "be distinguished from missing ones; give the map's folder");
  }
  const mapping::DetectionMap view_before = view_of(compared.before.mapped, 0.0);
  const mapping::DetectionMap view_now = view_of(now.mapped, 0.0);
  compared.alignment = register_map(compared.before, view_before, now, view_now, config);
  compared.comparison = mapping::compare_maps(compared.before.map.landmarks, now.map.landmarks,
                                              view_before, view_now, compared.alignment, {});
  return compared;
}

std::string person() {
  const passwd* user = ::getpwuid(::geteuid());
  const std::string who = user == nullptr ? "" : user->pw_name;
  return who.empty() || !io::is_correction_text(who) ? "unnamed" : who;
}

}  // namespace orchard::cli
