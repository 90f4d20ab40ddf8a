// SPDX-License-Identifier: BSD-3-Clause
#include "view/live_state.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "geometry/pose2.hpp"
#include "text/number_text.hpp"
#include "view/map_data.hpp"

namespace orchard::view {
using mapping::Landmark;

namespace {

/// Most tiles of the slow refresh contain no change.
bool is_same(const Landmark& a, const Landmark& b) {
  return a.id == b.id && a.label == b.label && a.num_observations == b.num_observations &&
         a.x_m == b.x_m && a.y_m == b.y_m && a.width_m == b.width_m && a.length_m == b.length_m &&
         a.probability == b.probability && a.row == b.row && a.position == b.position;
}

/// Max number of recent poses kept to place scans: some seconds of any localization.
constexpr std::size_t kRecentMax = 200;

/// Max number of images waiting for their DETECTIONS; the detector is never further behind.
constexpr std::size_t kImagesMax = 12;

}  // namespace

void LiveMap::touch(std::int32_t id, Entry& entry) {
  id_of_revision_.erase(entry.revision);
  entry.revision = ++revision_;
  id_of_revision_[entry.revision] = id;
}

void LiveMap::put(const Landmark& landmark) {
  Entry& entry = entries_[landmark.id];
  if (!entry.is_removed && is_same(landmark, entry.landmark)) return;
  entry.landmark = landmark;
  entry.is_removed = false;
  touch(landmark.id, entry);
}

void LiveMap::remove(std::int32_t id) {
  const auto found = entries_.find(id);
  if (found == entries_.end() || found->second.is_removed) return;
  found->second.is_removed = true;
  touch(id, found->second);
}

void LiveMap::take(const mapping::MapTile& tile) {
  const bool is_finished = tile.utime == finished_utime_;
  for (const Landmark& landmark : tile.landmarks) {
    if (!is_finished && landmark.num_observations < min_observations_) continue;
    Landmark now = landmark;
    if (is_finished) {
      for (const mapping::LongObject& object : long_objects_) {
        if (object.id != now.id) continue;
        now.length_m = object.length_m;
        now.direction_rad = object.direction_rad;
      }
    } else if (now.row == 0) {
      const Landmark& before = entries_[landmark.id].landmark;
      now.row = before.row;
      now.position = before.position;
    }
    put(now);
  }
  for (const std::int32_t id : tile.removed_ids) remove(id);
}

void LiveMap::finish(std::int64_t utime, std::vector<mapping::LongObject> long_objects) {
  finished_utime_ = utime;
  long_objects_ = std::move(long_objects);
}

void LiveMap::show(const std::vector<Landmark>& landmarks) {
  std::set<std::int32_t> ids;
  for (const Landmark& landmark : landmarks) {
    ids.insert(landmark.id);
    put(landmark);
  }
  for (const auto& [id, entry] : entries_) {
    if (ids.count(id) == 0) remove(id);
  }
}

void LiveMap::number(const std::vector<Landmark>& numbered) {
  for (const Landmark& landmark : numbered) {
    const auto found = entries_.find(landmark.id);
    if (found == entries_.end()) continue;
    Landmark& kept = found->second.landmark;
    if (kept.row == landmark.row && kept.position == landmark.position) continue;
    kept.row = landmark.row;
    kept.position = landmark.position;
    touch(landmark.id, found->second);
  }
}

LiveMap::Changes LiveMap::changes_since(std::int64_t revision, std::size_t num_most) const {
  Changes changes;
  changes.revision = revision;
  std::size_t num_left = num_most;
  for (auto at = id_of_revision_.upper_bound(revision); at != id_of_revision_.end() && num_left > 0;
       ++at, --num_left) {
    const Entry& entry = entries_.at(at->second);
    if (entry.is_removed) {
      changes.removed_ids.push_back(at->second);
    } else {
      changes.landmarks.push_back(entry.landmark);
    }
    changes.revision = at->first;
  }
  return changes;
}

std::string landmark_changes_json(const LiveMap::Changes& changes) {
  const auto id_text = [](std::int32_t id) { return std::to_string(id); };
  return fmt::format(R"("landmarks":{},"removed":{})", landmark_columns_json(changes.landmarks, {}),
                     array_json(changes.removed_ids, id_text));
}

std::vector<Landmark> LiveMap::landmarks() const {
  std::vector<Landmark> landmarks;
  for (const auto& [id, entry] : entries_) {
    if (!entry.is_removed) landmarks.push_back(entry.landmark);
  }
  return landmarks;
}

void LivePath::take(const pose::PoseEstimate& pose) {
  if (last_ && pose.utime < last_->utime) recent_.clear();  // the clock was set back
  last_ = pose;
  if (recent_.size() >= kRecentMax) {
    recent_.erase(recent_.begin(), recent_.begin() + kRecentMax / 2);
  }
  recent_.push_back(pose);
  add_point({pose.x_m, pose.y_m});
}

void LivePath::take(const pose::TrajectoryPage& page) {
  const auto trajectory = collector_.add(page);
  if (!trajectory) return;
  points_.clear();
  ++generation_;
  for (const pose::PoseEstimate& pose : trajectory->poses) add_point({pose.x_m, pose.y_m});
  for (const pose::PoseEstimate& pose : recent_) {
    if (pose.utime >= trajectory->utime) add_point({pose.x_m, pose.y_m});
  }
}

std::optional<geometry::Pose2> LivePath::pose_at(std::int64_t utime) const {
  for (std::size_t k = recent_.size(); k-- > 1;) {
    const pose::PoseEstimate &before = recent_[k - 1], &after = recent_[k];
    if (utime < before.utime || utime > after.utime) continue;
    const auto whole_us = static_cast<double>(after.utime - before.utime);
    const double fraction =
        whole_us > 0.0 ? static_cast<double>(utime - before.utime) / whole_us : 1.0;
    const double turn_rad = std::remainder(after.yaw_rad - before.yaw_rad, 2.0 * M_PI);
    return geometry::Pose2{before.x_m + fraction * (after.x_m - before.x_m),
                           before.y_m + fraction * (after.y_m - before.y_m),
                           before.yaw_rad + fraction * turn_rad};
  }
  if (!recent_.empty() && recent_.back().utime == utime) {
    return geometry::Pose2{recent_.back().x_m, recent_.back().y_m, recent_.back().yaw_rad};
  }
  return std::nullopt;
}

void LivePath::add_point(const Eigen::Vector2d& p) {
  if (!points_.empty() && (p - points_.back()).norm() < step_m_) return;
  points_.push_back(p);
  if (points_.size() < kPointsMax) return;
  std::vector<Eigen::Vector2d> fewer;
  for (std::size_t k = 0; k < points_.size(); k += 2) fewer.push_back(points_[k]);
  points_ = std::move(fewer);
  step_m_ *= 2.0;
  ++generation_;
}

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
    events.push_back(fmt::format(R"({{"kind":"path","is_new":{},"points":{}}})", is_new_path,
                                 points_json(path_.points(), seen.num_path_points)));
    seen.num_path_points = path_.points().size();
  }
  if (is_new(seen.pose, num_poses_) && path_.last()) {
    const pose::PoseEstimate& p = *path_.last();
    events.push_back(fmt::format(
        R"({{"kind":"pose","utime":{},"x":{},"y":{},"yaw":{},"covariance":[{},{},{}]}})", p.utime,
        fixed_text(p.x_m, 3), fixed_text(p.y_m, 3), fixed_text(p.yaw_rad, 4),
        shortest_text(p.covariance[0]), shortest_text(p.covariance[1]),
        shortest_text(p.covariance[3])));
  }
  if (is_new(seen.scan, num_scans_)) events.push_back(scan_event_);
  if (is_new(seen.observation, num_observations_)) {
    const std::string picture = "n=" + std::to_string(num_observations_);
    events.push_back("{\"kind\":\"look\"," + detections_json(detections_, rig_, picture) + "}");
  }
  return events;
}

}  // namespace orchard::view
