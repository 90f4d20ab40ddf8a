// SPDX-License-Identifier: BSD-3-Clause
#include "view/live_state.hpp"

#include <algorithm>

#include "geometry/pose2.hpp"
#include "text/number_text.hpp"
#include "view/map_data.hpp"

namespace orchard::view {
namespace {

/// Max number of images waiting for their DETECTIONS; the detector is never further behind.
constexpr std::size_t kImagesMax = 12;

}  // namespace

LiveState::LiveState(const detection::Rig& rig, int min_observations)
    : rig_(rig), map_(min_observations) {}

void LiveState::take(const laser::Scan& scan) {
  waiting_scan_ = scan;
  place_scan();
}

void LiveState::take(const pose::PoseEstimate& pose) {
  path_.take(pose);
  ++num_poses_;
  place_scan();
}

void LiveState::place_scan() {
  if (!waiting_scan_) return;
  const auto T_map_base = path_.pose_at(waiting_scan_->utime);
  if (!T_map_base) return;
  scan_event_ =
      "{\"kind\":\"scan\",\"points\":" + scan_points_json(*waiting_scan_, *T_map_base, rig_) + "}";
  ++num_scans_;
  waiting_scan_.reset();
}

void LiveState::take(const vision::Image& image) {
  images_.push_back(image);
  if (images_.size() > kImagesMax) images_.pop_front();
  // Without a detector, show the plain image.
  if (detections_.utime == 0) show(image);
}

void LiveState::take(const detection::Detections& detections) {
  const auto found = std::find_if(images_.begin(), images_.end(), [&](const vision::Image& image) {
    return image.utime == detections.image_utime;
  });
  if (found == images_.end()) return;
  detections_ = detections;
  show(*found);
  images_.erase(images_.begin(), found);
}

void LiveState::show(const vision::Image& image) {
  shown_ = std::make_shared<ShownPicture>(shown_picture(image));
  ++num_observations_;
}

void LiveState::take(const mapping::MapTile& tile) {
  if (tile.utime > ways_utime_) ways_ = nullptr;  // the map grows again
  map_.take(tile);
}

void LiveState::take(const mapping::MapWays& part) {
  auto whole = ways_collector_.add(part);
  if (!whole) return;
  ways_utime_ = whole->utime;
  ways_ = std::make_shared<mapping::NavigationGraph>(std::move(whole->graph));
  map_.finish(whole->utime, std::move(whole->long_objects));
}

void LiveState::take_rows(const std::vector<mapping::Landmark>& numbered,
                          std::string rows_and_ways) {
  map_.number(numbered);
  rows_event_ = "{\"kind\":\"rows\"," + std::move(rows_and_ways) + "}";
  ++num_rows_;
}

void LiveState::take_corrected(const std::vector<mapping::Landmark>& corrected, std::string event) {
  if (!corrected_) corrected_ = map_;
  corrected_->show(corrected);
  corrections_event_ = std::move(event);
  ++num_corrections_;
}

void LiveState::take_status(std::string event) {
  status_event_ = std::move(event);
  ++num_status_;
}

std::vector<std::string> LiveState::events_for(ViewerProgress& seen, bool& is_more) const {
  std::vector<std::string> events;
  const auto is_new = [](std::int64_t& was, std::int64_t now) {
    const bool differs = was != now;
    was = now;
    return differs;
  };
  if (is_new(seen.status, num_status_)) events.push_back(status_event_);
  if (is_new(seen.corrections, num_corrections_)) events.push_back(corrections_event_);
  const LiveMap& shown = corrected_ ? *corrected_ : map_;
  if (seen.map != shown.revision()) {
    const LiveMap::Changes changes = shown.changes_since(seen.map, kLandmarksOfEvent);
    events.push_back("{\"kind\":\"map\"," + landmark_changes_json(changes) + "}");
    seen.map = changes.revision;
  }
  is_more = seen.map != shown.revision();
  if (is_new(seen.rows, num_rows_)) events.push_back(rows_event_);
  const bool is_new_path = is_new(seen.path_generation, path_.generation());
  if (is_new_path) seen.num_path_points = 0;
  if (is_new_path || seen.num_path_points != path_.points().size()) {
    events.push_back(std::string("{\"kind\":\"path\",\"is_new\":") +
                     (is_new_path ? "true" : "false") +
                     ",\"points\":" + points_json(path_.points(), seen.num_path_points) + "}");
    seen.num_path_points = path_.points().size();
  }
  if (is_new(seen.pose, num_poses_) && path_.last()) {
    const pose::PoseEstimate& p = *path_.last();
    events.push_back("{\"kind\":\"pose\",\"utime\":" + std::to_string(p.utime) +
                     ",\"x\":" + fixed_text(p.x_m, 3) + ",\"y\":" + fixed_text(p.y_m, 3) +
                     ",\"yaw\":" + fixed_text(p.yaw_rad, 4) + ",\"covariance\":[" +
                     shortest_text(p.covariance[0]) + "," + shortest_text(p.covariance[1]) + "," +
                     shortest_text(p.covariance[3]) + "]}");
  }
  if (is_new(seen.scan, num_scans_)) events.push_back(scan_event_);
  if (is_new(seen.observation, num_observations_)) {
    events.push_back("{\"kind\":\"look\"," +
                     detections_json(detections_, rig_, "n=" + std::to_string(num_observations_)) +
                     "}");
  }
  return events;
}

}  // namespace orchard::view
