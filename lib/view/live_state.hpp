// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "detection/detection.hpp"
#include "detection/rig.hpp"
#include "geometry/pose2.hpp"
#include "laser/scan.hpp"
#include "mapping/finish/map_ways.hpp"
#include "mapping/landmark.hpp"
#include "pose/pose_estimate.hpp"
#include "view/detections_json.hpp"
#include "vision/image.hpp"

namespace orchard::view {

/// The map from MAP messages with a revision per change, so that each viewer can be sent the
/// changes since its last request.
class LiveMap {
 public:
  /// Landmarks with fewer than `min_observations` observations are not shown.
  explicit LiveMap(int min_observations) : min_observations_(min_observations) {}

  void take(const mapping::MapTile& tile);

  /// The tiles of this time are the finished map: their numbers hold, even none, and no landmark
  /// has too few observations. Long objects get their extents. Later tiles are again as before.
  void finish(std::int64_t utime, std::vector<mapping::LongObject> long_objects);

  /// Shows exactly these landmarks from now on, regardless of `min_observations`, and removes the
  /// others.
  void show(const std::vector<mapping::Landmark>& landmarks);

  /// Sets rows and positions found so far; tiles contain them only when the map is finished.
  void number(const std::vector<mapping::Landmark>& numbered);

  /// Changes since a revision.
  struct Changes {
    std::vector<mapping::Landmark> landmarks;
    std::vector<std::int32_t> removed_ids;
    std::int64_t revision = 0;  ///< for the next request
  };
  /// Returns the first `num_most` changes after a revision (0: from the beginning).
  Changes changes_since(std::int64_t revision, std::size_t num_most) const;

  /// Incremented with every change.
  std::int64_t revision() const { return revision_; }

  /// All landmarks that are shown, in order of id.
  std::vector<mapping::Landmark> landmarks() const;

 private:
  struct Entry {
    mapping::Landmark landmark;
    bool is_removed = false;
    std::int64_t revision = 0;
  };
  void put(const mapping::Landmark& landmark);
  void remove(std::int32_t id);
  void touch(std::int32_t id, Entry& entry);

  int min_observations_;
  std::optional<std::int64_t> finished_utime_;  ///< of the tiles of the finished map
  std::vector<mapping::LongObject> long_objects_;
  std::map<std::int32_t, Entry> entries_;                ///< by id
  std::map<std::int64_t, std::int32_t> id_of_revision_;  ///< latest revision of each id
  std::int64_t revision_ = 0;
};

/// Formats changes as `"landmarks": columns, "removed": [id]`, without braces.
std::string landmark_changes_json(const LiveMap::Changes& changes);

/// Path of the robot with bounded memory: points at a step that grows with the length, and the
/// poses of the last seconds.
class LivePath {
 public:
  /// Max number of points; beyond it every second point is dropped and the step doubles.
  static constexpr std::size_t kPointsMax = 20000;

  void take(const pose::PoseEstimate& pose);

  /// Adds a page of the corrected trajectory; with the last page the path is replaced.
  void take(const pose::TrajectoryPage& page);

  const std::optional<pose::PoseEstimate>& last() const { return last_; }

  /// Interpolated pose of base among the last poses; none outside their times.
  std::optional<geometry::Pose2> pose_at(std::int64_t utime) const;

  const std::vector<Eigen::Vector2d>& points() const { return points_; }

  /// Incremented whenever existing points have changed.
  std::int64_t generation() const { return generation_; }

 private:
  void add_point(const Eigen::Vector2d& p);

  std::optional<pose::PoseEstimate> last_;
  std::vector<pose::PoseEstimate> recent_;
  std::vector<Eigen::Vector2d> points_;
  double step_m_ = 0.05;
  std::int64_t generation_ = 0;
  pose::TrajectoryCollector collector_;
};

/// What has already been sent to a viewer.
struct ViewerProgress {
  std::int64_t map = 0, path_generation = -1, pose = 0, scan = 0, observation = 0, rows = 0,
               status = 0;
  std::int64_t corrections = 0;
  std::size_t num_path_points = 0;
};

/// The latest state of a live drive, with bounded memory, independent of the number of viewers.
///
/// Events are JSON objects with a "kind": "map" {"landmarks" in columns, "removed"}, "path"
/// {"is_new", "points" [x, y, ...]}, "pose" {"utime", "x", "y", "yaw", "covariance" xx xy yy},
/// "scan" {"points" [x, y, ...]}, "look" (see detections_json()), "rows" {"rows", "ways"},
/// "status", "corrections". Map frame, metres.
class LiveState {
 public:
  /// Max number of landmarks in one event.
  static constexpr std::size_t kLandmarksOfEvent = 1000;

  LiveState(const detection::Rig& rig, int min_observations);

  void take(const laser::Scan& scan);
  void take(const vision::Image& image);
  void take(const detection::Detections& detections);
  void take(const pose::PoseEstimate& pose);
  void take(const pose::TrajectoryPage& page) { path_.take(page); }
  void take(const mapping::MapTile& tile);
  void take(const mapping::MapWays& part);

  /// The ways of the finished map; null while the map grows.
  std::shared_ptr<const mapping::NavigationGraph> ways() const { return ways_; }

  /// Sets the numbered landmarks and the output of rows_and_ways_json().
  void take_rows(const std::vector<mapping::Landmark>& numbered, std::string rows_and_ways);

  /// Shows the manually corrected map instead of MAP from now on; `event` is a complete event of
  /// kind "corrections" (procs::corrections_event()).
  void take_corrected(const std::vector<mapping::Landmark>& corrected, std::string event);

  /// Sets a complete event of kind "status".
  void take_status(std::string event);

  std::vector<mapping::Landmark> landmarks() const { return map_.landmarks(); }
  /// Revision of the map from MAP, without corrections.
  std::int64_t map_revision() const { return map_.revision(); }

  /// Returns the events that are new to a viewer, at most one of each kind, and updates `seen`.
  /// `is_more`: further landmarks remain to be sent.
  std::vector<std::string> events_for(ViewerProgress& seen, bool& is_more) const;

  /// Image of the last "look" event; null if there is none.
  std::shared_ptr<const ShownPicture> picture() const { return shown_; }

 private:
  void place_scan();
  void show(const vision::Image& image);

  detection::Rig rig_;
  LiveMap map_;
  std::optional<LiveMap> corrected_;  ///< shown instead of map_ once there are corrections
  mapping::MapWaysCollector ways_collector_;
  std::shared_ptr<const mapping::NavigationGraph> ways_;
  std::int64_t ways_utime_ = 0;
  LivePath path_;
  std::int64_t num_poses_ = 0, num_scans_ = 0, num_observations_ = 0, num_rows_ = 0,
               num_status_ = 0, num_corrections_ = 0;
  std::optional<laser::Scan> waiting_scan_;
  std::string scan_event_, rows_event_, status_event_, corrections_event_;
  std::deque<vision::Image> images_;  ///< the last few, until their DETECTIONS arrive
  std::shared_ptr<const ShownPicture> shown_;
  detection::Detections detections_;  ///< of the image shown
};

}  // namespace orchard::view
