// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "detection/detection.hpp"
#include "detection/rig.hpp"
#include "laser/scan.hpp"
#include "view/detections_json.hpp"
#include "view/live_map.hpp"
#include "view/live_path.hpp"
#include "vision/image.hpp"

namespace orchard::view {

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
