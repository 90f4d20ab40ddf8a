// SPDX-License-Identifier: BSD-3-Clause
#include "cli/maps/stored_content.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "geometry/point_grid.hpp"

namespace orchard::cli {

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

io::MapFolderContent content_of(const io::StoredMap& map) {
  io::MapFolderContent content;
  content.landmarks = map.landmarks;
  content.next_id = map.next_id;
  content.georeference = map.georeference;
  content.view = map.view;
  content.summary = summary_of(map);
  content.graph = map.graph;
  if (map.trajectories.empty()) return content;
  content.trajectory = map.trajectories.front();
  content.more_trajectories.assign(map.trajectories.begin() + 1, map.trajectories.end());
  return content;
}

}  // namespace orchard::cli
