// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/beam_times.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/angles.hpp"
#include "geometry/statistics.hpp"

namespace orchard::procs {
namespace {

/// Min number of such scans before the finding is reported; a single one may be a jump of the pose.
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
      "sensors.yaml of the recording",
      num_moved_, num_scans_, sum_moved_m_ / static_cast<double>(num_moved_));
}

}  // namespace orchard::procs
