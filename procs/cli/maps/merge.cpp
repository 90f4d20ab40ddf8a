// SPDX-License-Identifier: BSD-3-Clause
#include "cli/maps/merge.hpp"
#include "geometry/pose2.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <utility>

#include "bus/node/process.hpp"
#include "cli/load_rig.hpp"
#include "cli/maps/map_laying.hpp"
#include "geometry/angles.hpp"
#include "io/config/config.hpp"
#include "io/file_error.hpp"
#include "io/map/map_folder.hpp"
#include "io/progress_bar.hpp"
#include "mapping/compare/landmark_pairing.hpp"
#include "mapping/compare/map_merging.hpp"

namespace orchard::cli {
namespace {

std::vector<pose::PoseEstimate> transformed(const std::vector<pose::PoseEstimate>& trajectory,
                                            const geometry::Pose2& T_a_b) {
  std::vector<pose::PoseEstimate> result = trajectory;
  for (pose::PoseEstimate& pose : result) {
    const Eigen::Vector2d p = transform(T_a_b, {pose.x_m, pose.y_m});
    pose.x_m = p.x();
    pose.y_m = p.y();
    pose.yaw_rad = geometry::wrap_angle_rad(pose.yaw_rad + T_a_b.yaw_rad);
  }
  return result;
}

void append_ids(std::size_t number, const std::vector<mapping::KeptId>& ids, std::string& text) {
  for (const mapping::KeptId& id : ids) {
    text += std::to_string(number) + "," + std::to_string(id.before) + "," +
            std::to_string(id.now) + "\n";
  }
}

/// The first of the maps that are left which can be laid on what is there, and how. Throws
/// io::FileError, why the first cannot be, when none can.
std::pair<std::size_t, mapping::MapAlignment> next_to_lay(const io::StoredMap& whole,
                                                          const std::vector<io::StoredMap>& maps,
                                                          const std::vector<std::size_t>& left,
                                                          const MergeOptions& options) {
  const mapping::DetectionMap view = view_of(whole, options.reach_m);
  std::string reason;
  for (std::size_t next = 0; next < left.size(); ++next) {
    const io::StoredMap& map = maps[left[next]];
    try {
      return {next, lay_on(whole, view, map, view_of(map, options.reach_m), options.alignment)};
    } catch (const io::FileError& error) {
      if (reason.empty()) reason = error.what();
    }
  }
  throw io::FileError(reason);
}

/// Maps keep no beams: what lies beside a driven path, where nothing was mapped, was seen free.
mapping::SeenFree beside_paths(const std::vector<std::vector<pose::PoseEstimate>>& trajectories) {
  constexpr double kBeside_m = 1.0;
  std::vector<Eigen::Vector2d> path;
  for (const auto& trajectory : trajectories) {
    for (const pose::PoseEstimate& pose : trajectory) path.push_back({pose.x_m, pose.y_m});
  }
  const auto points = std::make_shared<mapping::IndexedPoints>(std::move(path));
  return [points](const Eigen::Vector2d& p) { return points->nearest(p, kBeside_m) >= 0; };
}

void number(const mapping::RowsConfig& config, io::MapFolderContent& content) {
  if (!config.enabled) return;
  content.rows = mapping::find_rows(content.landmarks, config);
  const bool has_numbers = std::any_of(content.landmarks.begin(), content.landmarks.end(),
                                       [](const mapping::Landmark& l) { return l.row != 0; });
  if (has_numbers) {
    mapping::KeptNumbers kept;
    const std::vector<mapping::Landmark> known = content.landmarks;
    mapping::keep_numbers(known, content.rows, content.landmarks, kept);
  } else {
    mapping::number_landmarks(content.rows, content.landmarks);
  }
}

}  // namespace

int run_merge(const MergeOptions& options) {
  const mapping::RowsConfig rows = options.config_path.empty()
                                       ? mapping::RowsConfig{}
                                       : load_rig(options.config_path).mapper.rows;
  std::vector<io::StoredMap> maps;
  for (const std::string& path : options.map_paths) maps.push_back(io::read_stored_map(path));
  require_other_folder(options.out_folder, options.map_paths);

  io::StoredMap whole = maps.front();
  whole.name = options.map_paths.front();
  mapping::MergedMap merged{whole.landmarks, whole.next_id};
  std::vector<std::string> ids_of_map(maps.size());
  std::vector<mapping::KeptId> first_ids;
  for (const mapping::Landmark& l : whole.landmarks) first_ids.push_back({l.id, l.id});
  append_ids(1, first_ids, ids_of_map[0]);
  std::vector<std::size_t> left;
  for (std::size_t k = 1; k < maps.size(); ++k) left.push_back(k);
  io::ProgressBar bar("merging");
  while (!left.empty()) {
    bar.update(maps.size() - 1 - left.size(), maps.size() - 1);
    // A map that touches only a later one waits for it.
    const auto [next, alignment] = next_to_lay(whole, maps, left, options);
    const std::size_t k = left[next];
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(next));
    append_ids(k + 1, mapping::merge_into(merged, maps[k].landmarks, alignment), ids_of_map[k]);
    bar.finish();
    std::printf(
        "%s: laid on %zu trunks, %.0f mm apart (RMS); moved by %.3f m, %.3f m and %.3f "
        "degrees\n",
        options.map_paths[k].c_str(), alignment.pairs.size(), 1e3 * alignment.rms_m,
        alignment.T_a_b.x_m, alignment.T_a_b.y_m, alignment.T_a_b.yaw_rad * 180.0 / geometry::kPi);
    whole.landmarks = merged.landmarks;
    for (const auto& trajectory : maps[k].trajectories) {
      whole.trajectories.push_back(transformed(trajectory, alignment.T_a_b));
    }
  }
  std::string ids_csv = "map,id,merged_id\n";
  for (const std::string& ids : ids_of_map) ids_csv += ids;

  io::MapFolderContent content;
  content.landmarks = merged.landmarks;
  content.next_id = merged.next_id;
  content.ids_csv = ids_csv;
  content.georeference = whole.georeference;
  content.view = whole.view;
  if (!whole.trajectories.empty()) {
    content.trajectory = whole.trajectories.front();
    content.more_trajectories.assign(whole.trajectories.begin() + 1, whole.trajectories.end());
    content.summary.first_utime = content.trajectory.front().utime;
    for (const auto& trajectory : whole.trajectories) {
      content.summary.first_utime = std::min(content.summary.first_utime, trajectory.front().utime);
      content.summary.last_utime = std::max(content.summary.last_utime, trajectory.back().utime);
    }
  }
  content.summary.version = ORCHARD_VERSION;
  content.summary.source = "merged";
  for (std::size_t k = 0; k < maps.size(); ++k) {
    content.summary.counts.push_back({"map_" + std::to_string(k + 1) + "_landmarks",
                                      static_cast<std::int64_t>(maps[k].landmarks.size())});
  }
  if (!whole.trajectories.empty()) content.seen_free = beside_paths(whole.trajectories);
  number(rows, content);
  io::write_map_folder(options.out_folder, content);
  std::printf("%zu landmarks from %zu maps, written to %s; ids.csv says which became which\n",
              content.landmarks.size(), maps.size(), options.out_folder.c_str());
  return bus::kExitOk;
}

}  // namespace orchard::cli
