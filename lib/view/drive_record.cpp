// SPDX-License-Identifier: BSD-3-Clause
#include "view/drive_record.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "geometry/thinned_line.hpp"
#include "text/number_text.hpp"
#include "view/detections_json.hpp"
#include "view/map_data.hpp"

namespace orchard::view {

using mapping::Landmark;

namespace {

// Max content of one response: some hundred kilobytes.
constexpr std::size_t kStepsOfNews = 4000, kChangesOfNews = 2000, kPathsOfNews = 20;

// Minimum visible changes: lines are a pixel wide in a view of about ten metres.
constexpr double kSeen_m = 0.005;
constexpr double kSeenProbability = 0.05;
constexpr double kPathStep_m = 0.05;

/// After each such number of kept paths, the rate of keeping corrected paths is halved.
constexpr std::size_t kPathsPerStride = 100;

bool are_shown_alike(const Landmark& a, const Landmark& b) {
  return a.label == b.label && std::abs(a.x_m - b.x_m) < kSeen_m &&
         std::abs(a.y_m - b.y_m) < kSeen_m && std::abs(a.width_m - b.width_m) < kSeen_m &&
         std::abs(a.probability - b.probability) < kSeenProbability && a.row == b.row &&
         a.position == b.position;
}

template <class Items, class TextOf>
std::string list_json(const Items& items, std::size_t from, std::size_t to, const TextOf& text_of) {
  std::string text = "[";
  for (std::size_t k = from; k < to; ++k) {
    if (k > from) text += ',';
    text += text_of(items[k]);
  }
  return text + "]";
}

}  // namespace

void DriveRecord::take(const detection::Detections& detections) {
  if (!step_utimes_.empty() && detections.utime <= step_utimes_.back()) return;
  step_utimes_.push_back(detections.utime);
}

void DriveRecord::take(const pose::PoseEstimate& p) {
  if (!poses_.empty() && p.utime <= poses_.back().utime) return;
  poses_.push_back(
      {p.utime, p.x_m, p.y_m, p.yaw_rad, p.covariance[0], p.covariance[1], p.covariance[3]});
}

void DriveRecord::take(const pose::TrajectoryPage& page) {
  const auto trajectory = collector_.add(page);
  if (!trajectory || trajectory->poses.empty()) return;
  std::vector<Eigen::Vector2d> line;
  for (const pose::PoseEstimate& pose : trajectory->poses) line.push_back({pose.x_m, pose.y_m});
  Path path{step_of(trajectory->utime), points_json(geometry::thinned_line(line, kPathStep_m), 0)};
  if (num_paths_++ % path_stride_ != 0) {
    skipped_path_ = std::move(path);
    return;
  }
  skipped_path_.reset();
  paths_.push_back(std::move(path));
  if (paths_.size() % kPathsPerStride == 0) path_stride_ *= 2;
}

void DriveRecord::take(const mapping::MapTile& tile) {
  const std::size_t step = step_of(tile.utime);
  for (const Landmark& landmark : tile.landmarks) {
    if (landmark.num_observations >= min_observations_) put(step, landmark, false);
  }
  for (const std::int32_t id : tile.removed_ids) remove(step, id);
}

void DriveRecord::finish(const std::vector<Landmark>& landmarks) {
  is_done_ = true;
  if (skipped_path_) paths_.push_back(*skipped_path_);
  const std::size_t last = step_utimes_.empty() ? 0 : step_utimes_.size() - 1;
  std::set<std::int32_t> ids;
  for (const Landmark& landmark : landmarks) ids.insert(landmark.id);
  std::vector<std::int32_t> gone;
  for (const auto& [id, landmark] : shown_) {
    if (ids.count(id) == 0) gone.push_back(id);
  }
  for (const std::int32_t id : gone) remove(last, id);
  for (const Landmark& landmark : landmarks) put(last, landmark, true);
}

void DriveRecord::put(std::size_t step, const Landmark& landmark, bool exactly) {
  const auto found = shown_.find(landmark.id);
  if (found != shown_.end() && !exactly && are_shown_alike(found->second, landmark)) return;
  shown_[landmark.id] = landmark;
  if (!changes_.empty()) step = std::max(step, changes_.back().step);
  changes_.push_back({step, false, landmark});
}

void DriveRecord::remove(std::size_t step, std::int32_t id) {
  const auto found = shown_.find(id);
  if (found == shown_.end()) return;
  if (!changes_.empty()) step = std::max(step, changes_.back().step);
  changes_.push_back({step, true, found->second});
  shown_.erase(found);
}

std::size_t DriveRecord::step_of(std::int64_t utime) const {
  const auto after = std::upper_bound(step_utimes_.begin(), step_utimes_.end(), utime);
  return after == step_utimes_.begin() ? 0
                                       : static_cast<std::size_t>(after - step_utimes_.begin()) - 1;
}

std::size_t DriveRecord::num_steps() const {
  if (is_done_) return step_utimes_.size();
  if (poses_.empty()) return 0;
  const auto end = std::upper_bound(step_utimes_.begin(), step_utimes_.end(), poses_.back().utime);
  return static_cast<std::size_t>(end - step_utimes_.begin());
}

std::optional<DriveRecord::Pose> DriveRecord::full_pose_at(std::size_t step) const {
  const std::int64_t utime = step_utimes_.at(step);
  const auto after = std::lower_bound(poses_.begin(), poses_.end(), utime,
                                      [](const Pose& p, std::int64_t t) { return p.utime < t; });
  if (after == poses_.end()) {
    return poses_.empty() ? std::nullopt : std::optional<Pose>(poses_.back());
  }
  if (after == poses_.begin() || after->utime == utime) {
    return after->utime == utime ? std::optional<Pose>(*after) : std::nullopt;
  }
  const Pose &a = *std::prev(after), &b = *after;
  const double fraction =
      static_cast<double>(utime - a.utime) / static_cast<double>(b.utime - a.utime);
  Pose p = b;
  p.utime = utime;
  p.x_m = a.x_m + fraction * (b.x_m - a.x_m);
  p.y_m = a.y_m + fraction * (b.y_m - a.y_m);
  p.yaw_rad = a.yaw_rad + fraction * std::remainder(b.yaw_rad - a.yaw_rad, 2.0 * M_PI);
  return p;
}

std::optional<geometry::Pose2> DriveRecord::pose_at(std::size_t step) const {
  const auto p = full_pose_at(step);
  if (!p) return std::nullopt;
  return geometry::Pose2{p->x_m, p->y_m, p->yaw_rad};
}

std::string DriveRecord::news_json(DriveProgress& seen) const {
  const std::size_t total = num_steps();
  const std::size_t from = std::min(seen.steps, total), to = std::min(total, from + kStepsOfNews);
  std::string t, x, y, yaw, covariance;
  for (std::size_t k = from; k < to; ++k) {
    const char* comma = k > from ? "," : "";
    const auto p = full_pose_at(k);
    t += comma + std::to_string((step_utimes_[k] - step_utimes_.front()) / 1000);
    x += comma + (p ? fixed_text(p->x_m, 3) : "null");
    y += comma + (p ? fixed_text(p->y_m, 3) : "null");
    yaw += comma + (p ? fixed_text(p->yaw_rad, 4) : "null");
    covariance +=
        comma + (p ? shortest_text(p->xx) + "," + shortest_text(p->xy) + "," + shortest_text(p->yy)
                   : "0,0,0");
  }
  std::string text = "\"from\":" + std::to_string(from) + ",\"t\":[" + t + "],\"x\":[" + x +
                     "],\"y\":[" + y + "],\"yaw\":[" + yaw + "],\"covariance\":[" + covariance +
                     "]";

  const std::size_t change = std::min(seen.changes, changes_.size());
  const std::size_t change_end = std::min(changes_.size(), change + kChangesOfNews);
  std::vector<Landmark> landmarks;
  for (std::size_t k = change; k < change_end; ++k) landmarks.push_back(changes_[k].landmark);
  text += ",\"changes\":{\"step\":" +
          list_json(changes_, change, change_end,
                    [](const Change& c) { return std::to_string(c.step); }) +
          ",\"removed\":" +
          list_json(changes_, change, change_end,
                    [](const Change& c) { return c.is_removed ? "1" : "0"; }) +
          ",\"landmarks\":" + landmark_columns_json(landmarks, {}) + "}";

  const std::size_t path = std::min(seen.paths, paths_.size());
  const std::size_t path_end = std::min(paths_.size(), path + kPathsOfNews);
  text += ",\"paths\":" + list_json(paths_, path, path_end, [](const Path& p) {
            return "{\"step\":" + std::to_string(p.step) + ",\"points\":" + p.points + "}";
          });
  seen = {to, change_end, path_end};
  const bool is_more = to < total || change_end < changes_.size() || path_end < paths_.size();
  return text + ",\"num_steps\":" + std::to_string(total) +
         ",\"is_done\":" + (is_done_ ? "true" : "false") +
         ",\"is_more\":" + (is_more ? "true" : "false");
}

}  // namespace orchard::view
