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
#include "view/live_map.hpp"
#include "view/live_path.hpp"
#include "view/look_json.hpp"
#include "vision/image.hpp"

namespace orchard::view {

/// What somebody who looks on has been told already.
struct Seen {
  std::int64_t map = 0, path_generation = -1, pose = 0, scan = 0, observation = 0, rows = 0,
               status = 0;
  std::int64_t corrections = 0;
  std::size_t num_path_points = 0;
};

/// What a live drive shows, of which only the newest counts: bounded, whoever looks on or not.
///
/// Events are JSON objects, each with "kind": "map" {"landmarks" in columns, "removed"}, "path"
/// {"is_new", "points" [x, y, ...]}, "pose" {"utime", "x", "y", "yaw", "covariance" xx xy yy},
/// "scan"
/// {"points" [x, y, ...]}, "look" (see look_json()), "rows" {"rows", "ways"}, "status",
/// "corrections". Map frame, metres.
class LiveState {
 public:
  /// Landmarks of one event at most.
  static constexpr std::size_t kLandmarksOfEvent = 1000;

  LiveState(const detection::Rig& rig, int min_observations);

  void take(const laser::Scan& scan);
  void take(const vision::Image& image);
  void take(const detection::Detections& detections);
  void take(const pose::PoseEstimate& pose);
  void take(const pose::TrajectoryPage& page) { path_.take(page); }
  void take(const mapping::MapTile& tile) { map_.take(tile); }

  /// What find_rows() made of landmarks(): their numbers, and rows_and_ways_json() in braces'
  /// place.
  void take_rows(const std::vector<mapping::Landmark>& numbered, std::string rows_and_ways);

  /// The map as people corrected it, from now on in the place of what MAP says; `event` is a whole
  /// event of kind "corrections" (procs::corrections_event()).
  void take_corrected(const std::vector<mapping::Landmark>& corrected, std::string event);

  /// A whole event of kind "status", which the caller has made.
  void take_status(std::string event);

  std::vector<mapping::Landmark> landmarks() const { return map_.landmarks(); }
  /// Of what MAP said, whatever people corrected.
  std::int64_t map_revision() const { return map_.revision(); }

  /// The events that are new to somebody, oldest kind first; at most one of each kind. `seen` is
  /// brought up to date. `is_more`: there are landmarks left to tell.
  std::vector<std::string> events_for(Seen& seen, bool& is_more) const;

  /// The picture that the last "look" is of; none yet: null.
  std::shared_ptr<const ShownPicture> picture() const { return shown_; }

 private:
  void place_scan();
  void show(const vision::Image& image);

  detection::Rig rig_;
  LiveMap map_;
  std::optional<LiveMap> corrected_;  ///< shown in its place once somebody has corrected it
  LivePath path_;
  std::int64_t num_poses_ = 0, num_scans_ = 0, num_observations_ = 0, num_rows_ = 0,
               num_status_ = 0, num_corrections_ = 0;
  std::optional<laser::Scan> waiting_scan_;
  std::string scan_event_, rows_event_, status_event_, corrections_event_;
  std::deque<vision::Image> images_;  ///< the last few, for the DETECTIONS that they belong to
  std::shared_ptr<const ShownPicture> shown_;
  detection::Detections detections_;  ///< of the picture shown
};

}  // namespace orchard::view
