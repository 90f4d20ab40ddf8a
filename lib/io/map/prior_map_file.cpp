// SPDX-License-Identifier: BSD-3-Clause
#include "io/map/prior_map_file.hpp"

#include <cmath>
#include <filesystem>

#include "geometry/pose2.hpp"
#include "io/file_error.hpp"
#include "io/map/map_csv.hpp"
#include "io/map/stored_map.hpp"
#include "mapping/compare/visibility.hpp"

namespace orchard::io {

namespace {

/// Position sigma in standard errors of the mean: observations of one pass are correlated, so a
/// single standard error is too optimistic.
constexpr double kStandardErrors = 2.0;

constexpr double kPathStep_m = 0.5;

std::vector<Eigen::Vector2d> laser_path(const StoredMap& map) {
  std::vector<Eigen::Vector2d> path_m;
  for (const std::vector<pose::PoseEstimate>& drive : map.trajectories) {
    bool is_first = true;
    for (const pose::PoseEstimate& pose : drive) {
      const Eigen::Vector2d p =
          geometry::transform(Eigen::Vector3d(pose.x_m, pose.y_m, pose.yaw_rad),
                              Eigen::Vector2d(map.view.mount_x_m, map.view.mount_y_m));
      if (!is_first && (p - path_m.back()).norm() < kPathStep_m) continue;
      path_m.push_back(p);
      is_first = false;
    }
  }
  return path_m;
}

/// Throws FileError when the landmarks are not sufficient for localization.
void require_places(const std::string& name, const std::vector<pose::PriorLandmark>& landmarks) {
  const std::string problem = pose::problem_with(landmarks);
  if (problem.empty()) return;
  throw FileError(name + " (pose.prior_map.map_file) cannot be used for localisation: it " +
                  problem);
}

}  // namespace

pose::PriorMapData read_prior_map(const pose::PriorMapConfig& config) {
  std::string path = config.map_file;
  std::error_code unknown;
  const bool is_folder = std::filesystem::is_directory(path, unknown);
  if (is_folder) path += "/map.csv";
  pose::PriorMapData earlier;
  std::vector<mapping::Landmark> used;
  for (const mapping::Landmark& l : read_map_csv(path)) {
    if (l.num_observations < config.min_observations) continue;
    pose::PriorLandmark landmark;
    landmark.p_map = {l.x_m, l.y_m};
    landmark.width_m = l.width_m;
    landmark.weight = l.num_observations;
    landmark.sd_m = kStandardErrors * std::hypot(l.se_x_m, l.se_y_m) / std::sqrt(2.0);
    earlier.landmarks.push_back(landmark);
    used.push_back(l);
  }
  require_places(path, earlier.landmarks);
  if (!is_folder) return earlier;
  const StoredMap map = read_stored_map(config.map_file);
  const mapping::DetectionMap view(map.landmarks, map.trajectories, map.view);
  for (std::size_t i = 0; i < used.size(); ++i) earlier.landmarks[i].rate = view.rate(used[i]);
  earlier.path_m = laser_path(map);
  earlier.reach_m = map.view.reach_m;
  return earlier;
}

}  // namespace orchard::io
