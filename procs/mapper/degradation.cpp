// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/degradation.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <vector>

#include "bus/messages/channel.hpp"
#include "geometry/angles.hpp"
#include "geometry/statistics.hpp"
#include "timing/drive_time.hpp"
#include "timing/units.hpp"

namespace orchard::procs {
namespace {

/// derived: Shorter gaps are normal: pictures are slower than scans, and fixes arrive once a
/// second.
constexpr std::int64_t kWithoutPicture_us = 3'000'000;
constexpr std::int64_t kWithoutFix_us = 5'000'000;

/// derived: a drive of ten hours keeps 36,000 ids.
constexpr std::int64_t kIdPeriod_us = 1'000'000;

/// derived: Limit for a loose contact; further intervals are merged into the last.
constexpr std::size_t kStretchesMax = 1000;

void add(std::vector<std::pair<std::int64_t, std::int64_t>>& spans, std::int64_t from,
         std::int64_t to) {
  if (spans.size() < kStretchesMax) {
    spans.emplace_back(from, to);
  } else {
    spans.back().second = to;
  }
}

/// The name of a channel, null-terminated in the table of channels.
const char* name_of(bus::Channel channel) { return bus::info(channel).name.data(); }

}  // namespace

void Degradation::note_scan(std::int64_t utime, std::int64_t image_utime, std::int32_t last_id) {
  if (!first_utime_) first_utime_ = last_picture_utime_ = utime;
  last_utime_ = std::max(last_utime_, utime);
  if (ids_.empty() || utime - ids_.back().first >= kIdPeriod_us) ids_.emplace_back(utime, last_id);
  ids_.back().second = std::max(ids_.back().second, last_id);
  if (image_utime != 0) {
    last_picture_utime_ = utime;
    is_open_ = false;
  } else if (has_camera_ && timing::elapsed_us(*last_picture_utime_, utime) > kWithoutPicture_us) {
    if (!is_open_) add(pictures_, *last_picture_utime_, utime);
    is_open_ = true;
    pictures_.back().second = utime;
  }
}

void Degradation::note_fix(std::int64_t utime) {
  if (!first_fix_utime_) first_fix_utime_ = utime;
  if (last_fix_utime_ && timing::elapsed_us(*last_fix_utime_, utime) > kWithoutFix_us) {
    add(fixes_, *last_fix_utime_, utime);
  }
  last_fix_utime_ = utime;
}

/// The highest landmark id up to a time.
std::int32_t Degradation::id_at(std::int64_t utime) const {
  const auto after =
      std::upper_bound(ids_.begin(), ids_.end(), utime,
                       [](std::int64_t time, const auto& entry) { return time < entry.first; });
  return after == ids_.begin() ? 0 : (after - 1)->second;
}

/// True if a scan was mapped between the two times.
bool Degradation::has_scan_between(std::int64_t after_utime, std::int64_t before_utime) const {
  const auto next =
      std::upper_bound(ids_.begin(), ids_.end(), after_utime,
                       [](std::int64_t time, const auto& entry) { return time < entry.first; });
  return next != ids_.end() && next->first < before_utime;
}

std::vector<io::DegradedInterval> Degradation::intervals() const {
  std::vector<io::DegradedInterval> all;
  if (!first_utime_) return all;
  const auto add_spans = [&](const char* missing, const std::vector<Span>& spans,
                             std::int64_t least_us) {
    for (Span span : spans) {
      span.first = std::max(span.first, *first_utime_);
      span.second = std::min(span.second, last_utime_);
      // Skip intervals in which the robot paused: nothing was mapped.
      if (!has_scan_between(span.first + least_us, span.second)) continue;
      all.push_back({missing, timing::utime_of(span.first), timing::utime_of(span.second),
                     id_at(span.first) + 1, id_at(span.second)});
    }
  };
  add_spans(name_of(bus::Channel::kImage), pictures_, kWithoutPicture_us);
  if (first_fix_utime_) {
    std::vector<Span> spans{{*first_utime_, *first_fix_utime_}};
    spans.insert(spans.end(), fixes_.begin(), fixes_.end());
    spans.emplace_back(*last_fix_utime_, last_utime_);
    add_spans(name_of(bus::Channel::kGnss), spans, kWithoutFix_us);
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.first_utime < b.first_utime; });
  return all;
}

std::string Degradation::text() const {
  std::string text;
  for (const char* missing : {name_of(bus::Channel::kImage), name_of(bus::Channel::kGnss)}) {
    int num = 0;
    double sum_s = 0.0;
    std::int64_t num_new = 0;
    for (const io::DegradedInterval& interval : intervals()) {
      if (interval.missing != missing) continue;
      ++num;
      sum_s += timing::seconds(interval.last_utime - interval.first_utime);
      num_new += std::max(0, interval.last_id - interval.first_id + 1);
    }
    if (num == 0) continue;
    text += fmt::format(
        "{}no {} for {:.1f} s in {} interval{} while mapping; {} landmarks were first seen then "
        "(see `degraded` in summary.json)",
        text.empty() ? "" : "; ", missing, sum_s, num, num == 1 ? "" : "s", num_new);
  }
  return text;
}

namespace {

/// derived: Min number of such scans before the finding is reported; a single one may be a jump of
/// the pose.
constexpr std::int64_t kMovedMin = 20;

}  // namespace

void BeamTimes::note_scan(const laser::Scan& scan) {
  turn_fraction_ = 0.0;
  std::vector<double> ranges_m;
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    if (scan.valid(i) && scan.ranges_m[i] < scan.range_max_m) ranges_m.push_back(scan.ranges_m[i]);
  }
  if (scan.beam_period_us > 0.0 || ranges_m.empty()) return;
  reach_m_ = geometry::median(std::move(ranges_m));
  turn_fraction_ = std::min(1.0, static_cast<double>(scan.ranges_m.size()) *
                                     std::abs(scan.bearing_step_rad) / (2.0 * geometry::kPi));
}

void BeamTimes::note_pose(std::int64_t utime, const geometry::Pose2& T_map_base) {
  const double since_s = 1e-6 * static_cast<double>(utime - utime_);
  const bool follows = utime_ != 0 && since_s > 0.0 && since_s <= gap_max_s_;
  // A scanner makes at most one turn between two scans: the motion between them, times the covered
  // fraction of a turn, bounds the motion during the sweep.
  if (turn_fraction_ > 0.0 && follows) {
    const double turned_rad = geometry::wrap_angle_rad(T_map_base.yaw_rad - yaw_rad_);
    const double moved_m =
        turn_fraction_ * (std::hypot(T_map_base.x_m - x_m_, T_map_base.y_m - y_m_) +
                          std::abs(turned_rad) * reach_m_);
    ++num_scans_;
    if (moved_m > range_sd_m_) {
      ++num_moved_;
      sum_moved_m_ += moved_m;
    }
  }
  utime_ = utime;
  x_m_ = T_map_base.x_m;
  y_m_ = T_map_base.y_m;
  yaw_rad_ = T_map_base.yaw_rad;
}

std::string BeamTimes::text() const {
  if (num_moved_ < kMovedMin) return {};
  return fmt::format(
      "SCAN has no beam times (beam_period_us is 0) and the robot moved during {} of {} scans, so "
      "landmarks may be displaced by about {:.2f} m; set beam_period_us in the laser driver, or in "
      "sensors.yaml of the recording (there negative if the head turns against the columns)",
      num_moved_, num_scans_, sum_moved_m_ / static_cast<double>(num_moved_));
}

}  // namespace orchard::procs
