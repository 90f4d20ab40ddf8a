// SPDX-License-Identifier: BSD-3-Clause
#include "view/live_state.hpp"

#include <algorithm>
#include <cmath>

#include "detection/trunk_view.hpp"
#include "geometry/pose2.hpp"
#include "text/number_text.hpp"
#include "view/bitmap.hpp"
#include "view/map_data.hpp"

namespace orchard::view {
namespace {

/// Pictures that wait for their DETECTIONS: a detector is never farther behind.
constexpr std::size_t kImagesMost = 12;

std::string points_text(const std::vector<Eigen::Vector2d>& points, std::size_t from) {
  std::string text = "[";
  for (std::size_t k = from; k < points.size(); ++k) {
    if (text.size() > 1) text += ',';
    text += fixed_text(points[k].x(), 2) + "," + fixed_text(points[k].y(), 2);
  }
  return text + "]";
}

/// Where the camera should have looked for a detection: a segment as wide as it, seen from the
/// laser.
std::optional<detection::TrunkView> window_of(const detection::Detection& d,
                                              const detection::Rig& rig) {
  laser::Segment segment;
  segment.range_m = segment.start_range_m = segment.end_range_m = d.range_m;
  segment.bearing_rad = d.bearing_rad;
  const double half_rad = std::atan2(0.5 * d.width_m, d.range_m + 0.5 * d.width_m);
  segment.start_bearing_rad = d.bearing_rad - half_rad;
  segment.end_bearing_rad = d.bearing_rad + half_rad;
  return detection::view_of(segment, rig);
}

std::string rect_text(const vision::PixelRect& rect) {
  return "[" + std::to_string(rect.x_px) + "," + std::to_string(rect.y_px) + "," +
         std::to_string(rect.width_px) + "," + std::to_string(rect.height_px) + "]";
}

const char* label_name(detection::Label label) {
  switch (label) {
    case detection::Label::kTree:
      return "0";
    case detection::Label::kObject:
      return "1";
    default:
      return "2";
  }
}

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
  const geometry::Pose2 T_base_laser{rig_.laser.mount_x_m, rig_.laser.mount_y_m,
                                     rig_.laser.mount_yaw_rad};
  std::vector<Eigen::Vector2d> points;
  for (std::size_t beam = 0; beam < waiting_scan_->ranges_m.size(); ++beam) {
    if (!waiting_scan_->valid(beam)) continue;
    const double range_m = waiting_scan_->ranges_m[beam];
    const double bearing_rad = waiting_scan_->bearing_rad(static_cast<double>(beam));
    const Eigen::Vector2d p_laser(range_m * std::cos(bearing_rad), range_m * std::sin(bearing_rad));
    points.push_back(geometry::transform(*T_map_base, geometry::transform(T_base_laser, p_laser)));
  }
  scan_event_ = "{\"kind\":\"scan\",\"points\":" + points_text(points, 0) + "}";
  ++num_scans_;
  waiting_scan_.reset();
}

void LiveState::take(const vision::Image& image) {
  images_.push_back(image);
  if (images_.size() > kImagesMost) images_.pop_front();
  // Without a detector the picture itself is all there is to show.
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
  auto picture = std::make_shared<ShownPicture>();
  picture->utime = image.utime;
  if (image.encoding == vision::Encoding::kJpeg) {
    picture->bytes.assign(image.data.begin(), image.data.end());
  } else {
    picture->type = "image/bmp";
    picture->bytes = bitmap(image);
  }
  shown_ = std::move(picture);
  ++num_looks_;
}

std::string LiveState::look_json() const {
  std::string text = "{\"kind\":\"look\",\"picture\":" + std::to_string(num_looks_) +
                     ",\"width\":" + std::to_string(detection::picture_of(rig_).width_px) +
                     ",\"height\":" + std::to_string(detection::picture_of(rig_).height_px) +
                     ",\"trunks\":[";
  bool is_first = true;
  for (const detection::Detection& d : detections_.trunks) {
    const auto window = window_of(d, rig_);
    if (!window) continue;
    if (!is_first) text += ',';
    is_first = false;
    text += std::string("{\"label\":") + label_name(d.label) +
            ",\"centre\":" + rect_text(window->centre) +
            ",\"left_edge\":" + rect_text(window->left_edge) +
            ",\"right_edge\":" + rect_text(window->right_edge) +
            ",\"range\":" + fixed_text(d.range_m, 2);
    const std::pair<const char*, float> rocs[] = {
        {"laser", d.roc_laser},      {"colour", d.roc_colour},     {"left", d.roc_left_edge},
        {"right", d.roc_right_edge}, {"parallel", d.roc_parallel}, {"edges", d.roc_edges},
        {"vision", d.roc_vision},    {"tree", d.roc_tree}};
    for (const auto& [name, roc] : rocs) {
      text += std::string(",\"") + name + "\":" + fixed_text(roc, 3);
    }
    text += "}";
  }
  return text + "]}";
}

void LiveState::take_rows(const std::vector<mapping::Landmark>& numbered,
                          std::string rows_and_ways) {
  map_.number(numbered);
  rows_event_ = "{\"kind\":\"rows\"," + std::move(rows_and_ways) + "}";
  ++num_rows_;
}

void LiveState::take_status(std::string event) {
  status_event_ = std::move(event);
  ++num_status_;
}

std::vector<std::string> LiveState::events_for(Seen& seen, bool& is_more) const {
  std::vector<std::string> events;
  const auto is_new = [](std::int64_t& was, std::int64_t now) {
    const bool differs = was != now;
    was = now;
    return differs;
  };
  if (is_new(seen.status, num_status_)) events.push_back(status_event_);
  if (seen.map != map_.revision()) {
    const LiveMap::Changes changes = map_.changes_since(seen.map, kLandmarksOfEvent);
    std::string removed = "[";
    for (const std::int32_t id : changes.removed_ids) {
      removed += (removed.size() > 1 ? "," : "") + std::to_string(id);
    }
    events.push_back(
        "{\"kind\":\"map\",\"landmarks\":" + landmark_columns_json(changes.landmarks, {}) +
        ",\"removed\":" + removed + "]}");
    seen.map = changes.revision;
  }
  is_more = seen.map != map_.revision();
  if (is_new(seen.rows, num_rows_)) events.push_back(rows_event_);
  const bool is_new_path = is_new(seen.path_generation, path_.generation());
  if (is_new_path) seen.num_path_points = 0;
  if (is_new_path || seen.num_path_points != path_.points().size()) {
    events.push_back(std::string("{\"kind\":\"path\",\"is_new\":") +
                     (is_new_path ? "true" : "false") +
                     ",\"points\":" + points_text(path_.points(), seen.num_path_points) + "}");
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
  if (is_new(seen.look, num_looks_)) events.push_back(look_json());
  return events;
}

}  // namespace orchard::view
