// SPDX-License-Identifier: BSD-3-Clause
#include "pose/rig/reference_path.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/pose2.hpp"
#include "pose/motion.hpp"
#include "timing/units.hpp"

namespace orchard::pose {
namespace {

/// physical: in a second a robot does what neither wheels before nor after it tell.
constexpr double kGap_s = 1.0;

/// The motion after a share of its time, along an arc: the chord's direction is half the turn.
Eigen::Vector3d share_of(const Eigen::Vector3d& motion, double share) {
  const double half_rad = 0.5 * motion.z();
  const bool is_straight = std::abs(half_rad) < 1e-9;
  const double length = is_straight ? share : std::sin(share * half_rad) / std::sin(half_rad);
  Eigen::Vector3d part;
  part << geometry::rotation((share - 1.0) * half_rad) * (length * motion.head<2>()),
      share * motion.z();
  return part;
}

}  // namespace

void ReferencePath::add(const Odometry& odometry) {
  if (entries_.empty()) {
    entries_.push_back({odometry.utime, {}, false});
    return;
  }
  const Entry& last = entries_.back();
  if (odometry.utime <= last.utime) return;
  const double period_s = timing::seconds(odometry.utime - last.utime);
  Entry next{odometry.utime, last.place, period_s <= kGap_s};
  if (next.follows) {
    const Eigen::Vector3d motion =
        arc_motion(odometry.speed_mps, odometry.yaw_rate_radps, period_s);
    next.place.T_path_base = geometry::compose(last.place.T_path_base, motion);
  } else {
    ++next.place.piece;
  }
  entries_.push_back(next);
}

void ReferencePath::add(const PoseFix& fix) {
  if (!fix.has_yaw || (!entries_.empty() && fix.utime <= entries_.back().utime)) return;
  const bool follows =
      !entries_.empty() && timing::seconds(fix.utime - entries_.back().utime) <= kGap_s;
  entries_.push_back({fix.utime, {{fix.x_m, fix.y_m, fix.yaw_rad}, 0}, follows});
}

std::optional<std::int64_t> ReferencePath::reached_utime() const {
  if (entries_.empty()) return std::nullopt;
  return entries_.back().utime;
}

std::optional<ReferencePath::Place> ReferencePath::at(std::int64_t utime) const {
  const auto after =
      std::lower_bound(entries_.begin(), entries_.end(), utime,
                       [](const Entry& entry, std::int64_t time) { return entry.utime < time; });
  if (after == entries_.end()) return std::nullopt;
  if (after->utime == utime) return after->place;
  if (after == entries_.begin() || !after->follows) return std::nullopt;
  const Entry& before = *std::prev(after);
  const double share =
      timing::seconds(utime - before.utime) / timing::seconds(after->utime - before.utime);
  const Eigen::Vector3d motion =
      geometry::between(before.place.T_path_base, after->place.T_path_base);
  return Place{geometry::compose(before.place.T_path_base, share_of(motion, share)),
               after->place.piece};
}

void ReferencePath::forget_before(std::int64_t utime) {
  while (entries_.size() > 2 && entries_[1].utime <= utime) entries_.pop_front();
}

}  // namespace orchard::pose
