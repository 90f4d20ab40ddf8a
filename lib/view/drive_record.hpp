// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "detection/detection.hpp"
#include "geometry/pose2.hpp"
#include "mapping/landmark.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::view {

/// How much of a drive has been sent to a page: numbers of steps, map changes and paths.
struct DriveProgress {
  std::size_t steps = 0, changes = 0, paths = 0;
};

/// Record of a drive, scan by scan: each scan is a step with the robot's pose, the map and the path
/// as estimated at that time.
///
/// Changes of a landmark too small to be visible on the page are not kept. Of many corrected paths
/// every second, later every fourth, is kept, and so on.
class DriveRecord {
 public:
  /// Landmarks with fewer than `min_observations` observations are not shown.
  explicit DriveRecord(int min_observations) : min_observations_(min_observations) {}

  /// Adds one step: the detections of its scan.
  void take(const detection::Detections& detections);
  void take(const pose::PoseEstimate& pose);
  void take(const pose::TrajectoryPage& page);
  void take(const mapping::MapTile& tile);

  /// Ends the drive with the finished, numbered map, which the last step shows.
  void finish(const std::vector<mapping::Landmark>& landmarks);

  /// Number of steps with a known pose; at the end all steps.
  std::size_t num_steps() const;
  std::int64_t utime_of(std::size_t step) const { return step_utimes_.at(step); }

  /// Pose of base at the scan of a step; none before the first pose.
  std::optional<geometry::Pose2> pose_at(std::size_t step) const;

  /// Returns the new data for a page as JSON without braces and updates `seen`: "from", "t" (ms
  /// after the first step), "x", "y", "yaw", "covariance" (xx, xy, yy of each); "changes": {"step",
  /// "removed", "landmarks": columns}; "paths": [{"step", "points"}], the path up to that step as
  /// estimated from then on; "num_steps", "is_done", "is_more".
  std::string news_json(DriveProgress& seen) const;

 private:
  struct Pose {
    std::int64_t utime = 0;
    double x_m = 0.0, y_m = 0.0, yaw_rad = 0.0;
    double xx = 0.0, xy = 0.0, yy = 0.0;
  };
  struct Change {
    std::size_t step = 0;
    bool is_removed = false;
    mapping::Landmark landmark;
  };
  struct Path {
    std::size_t step = 0;
    std::string points;
  };
  std::optional<Pose> full_pose_at(std::size_t step) const;
  std::size_t step_of(std::int64_t utime) const;
  void put(std::size_t step, const mapping::Landmark& landmark, bool exactly);
  void remove(std::size_t step, std::int32_t id);

  int min_observations_;
  bool is_done_ = false;
  std::vector<std::int64_t> step_utimes_;
  std::vector<Pose> poses_;
  std::vector<Change> changes_;
  std::map<std::int32_t, mapping::Landmark> shown_;  ///< state after the last change of each
  std::vector<Path> paths_;
  std::optional<Path> skipped_path_;  ///< the newest path, if it was skipped
  std::size_t num_paths_ = 0;
  std::size_t path_stride_ = 1;
  pose::TrajectoryCollector collector_;
};

}  // namespace orchard::view
