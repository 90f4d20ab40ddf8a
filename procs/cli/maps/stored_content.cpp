// SPDX-License-Identifier: BSD-3-Clause
#include "cli/maps/stored_content.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "mapping/compare/landmark_pairing.hpp"

namespace orchard::cli {
namespace {

mapping::FreeSpaceTest beside_paths(
    const std::vector<std::vector<pose::PoseEstimate>>& trajectories) {
  constexpr double kBeside_m = 1.0;
  std::vector<Eigen::Vector2d> path;
  for (const auto& trajectory : trajectories) {
    for (const pose::PoseEstimate& pose : trajectory) path.push_back({pose.x_m, pose.y_m});
  }
  const auto points = std::make_shared<mapping::IndexedPoints>(std::move(path));
  return [points](const Eigen::Vector2d& p) { return points->nearest(p, kBeside_m) >= 0; };
}

}  // namespace

io::MapFolderContent content_of(const io::StoredMap& map) {
  io::MapFolderContent content;
  content.landmarks = map.landmarks;
  content.next_id = map.next_id;
  content.georeference = map.georeference;
  content.view = map.view;
  content.summary.version = ORCHARD_VERSION;
  if (map.trajectories.empty()) return content;
  content.trajectory = map.trajectories.front();
  content.more_trajectories.assign(map.trajectories.begin() + 1, map.trajectories.end());
  content.summary.first_utime = content.trajectory.front().utime;
  for (const auto& trajectory : map.trajectories) {
    content.summary.first_utime = std::min(content.summary.first_utime, trajectory.front().utime);
    content.summary.last_utime = std::max(content.summary.last_utime, trajectory.back().utime);
  }
  content.seen_free = beside_paths(map.trajectories);
  return content;
}

}  // namespace orchard::cli
