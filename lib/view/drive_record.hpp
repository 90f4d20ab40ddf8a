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
#include "pose/trajectory.hpp"

namespace orchard::view {

/// How much of a drive a page has been told: so many steps, changes of the map, paths.
struct DriveSeen {
  std::size_t steps = 0, changes = 0, paths = 0;
};

/// A drive scan by scan, as it was known then: each scan is a step, with the robot's pose, the map
/// as grown until then and the path as believed then.
///
/// Of a landmark that is seen again and again only changes that can be seen on the page are kept;
/// of many corrected paths every second, then fourth, is kept.
class DriveRecord {
 public:
  /// Landmarks seen less often than `min_observations` are not shown.
  explicit DriveRecord(int min_observations) : min_observations_(min_observations) {}

  /// One step: its scan has been looked at.
  void take(const detection::Detections& detections);
  void take(const pose::PoseEstimate& pose);
  void take(const pose::TrajectoryPage& page);
  void take(const mapping::MapTile& tile);

  /// The finished, numbered map: the last step shows it.
  void finish(const std::vector<mapping::Landmark>& landmarks);

  /// Steps whose pose is known; all of them at the end.
  std::size_t num_steps() const;
  std::int64_t utime_of(std::size_t step) const { return step_utimes_.at(step); }

  /// Pose of base at a step's scan; none before the first pose.
  std::optional<geometry::Pose2> pose_at(std::size_t step) const;

  /// What is new to somebody, as JSON without braces, and `seen` brought up to date: "from", "t"
  /// (ms after the first step), "x", "y", "yaw", "covariance" (xx, xy, yy of each); "changes":
  /// {"step", "removed", "landmarks": columns}; "paths": [{"step", "points"}], the path until that
  /// step as it was believed from then on; "num_steps", "is_done", "is_more".
  std::string news_json(DriveSeen& seen) const;

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
  std::map<std::int32_t, mapping::Landmark> shown_;  ///< as the last change of each left it
  std::vector<Path> paths_;
  std::optional<Path> skipped_path_;  ///< the newest, where it was left out
  std::size_t num_paths_ = 0;
  std::size_t path_stride_ = 1;
  pose::TrajectoryCollector collector_;
};

}  // namespace orchard::view
