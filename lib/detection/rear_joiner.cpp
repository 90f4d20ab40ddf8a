// SPDX-License-Identifier: BSD-3-Clause
#include "detection/rear_joiner.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "geometry/angles.hpp"

namespace orchard::detection {
namespace {

/// physical: most scanners turn ten times a second.
constexpr std::int64_t kUnknownTurn_us = 100'000;

/// physical: margin for clock errors and variations of a scanner's speed.
constexpr double kTurnMargin = 1.1;

/// physical: max speed of a robot; bounds its motion between two observations of a trunk without
/// ODOMETRY.
constexpr double kSpeedMax_mps = 2.0;

/// derived: two seconds of motions at 500 Hz.
constexpr std::size_t kMotionsMax = 1024;

/// derived: five seconds; max number of sweeps of the second scanner that wait while the first one
/// is silent.
constexpr std::size_t kRearWaitingMax = 50;

/// Whether two detections overlap and therefore are the same object.
bool is_same(const Detection& a, const Detection& b, const std::optional<Motion>& motion) {
  const double since_s = 1e-6 * static_cast<double>(a.utime - b.utime);
  PlanePoint b_then{b.centre_x_m, b.centre_y_m};  // in base at the time of `a`
  if (motion) b_then = after_motion(b_then, *motion, since_s);
  const double apart_m = std::hypot(a.centre_x_m - b_then.x_m, a.centre_y_m - b_then.y_m);
  const double unknown_m = motion ? 0.0 : kSpeedMax_mps * std::abs(since_s);
  return apart_m < 0.5 * (a.width_m + b.width_m) + unknown_m;
}

bool is_more_certain(const Detection& a, const Detection& b) {
  const bool a_judged = a.label != Label::kUnseen;
  const bool b_judged = b.label != Label::kUnseen;
  if (a_judged != b_judged) return a_judged;
  return a.covariance[0] + a.covariance[2] < b.covariance[0] + b.covariance[2];
}

/// Sets range and bearing to those relative to a scanner at `mount`.
void set_range_and_bearing(Detection& d, const laser::LaserConfig& mount) {
  const double x_m = d.surface_x_m - mount.mount_x_m;
  const double y_m = d.surface_y_m - mount.mount_y_m;
  d.range_m = std::hypot(x_m, y_m);
  d.bearing_rad = geometry::wrap_angle_rad(std::atan2(y_m, x_m) - mount.mount_yaw_rad);
}

}  // namespace

std::int64_t turn_us(const laser::Scan& scan) {
  if (scan.beam_period_us <= 0.0) return kUnknownTurn_us;
  return std::llround(scan.beam_period_us * 2.0 * geometry::kPi / std::abs(scan.bearing_step_rad));
}

RearJoiner::RearJoiner(const laser::LaserConfig& mount, double wait_s, bool with_motion)
    : mount_(mount), queue_([wait_s, with_motion] {
        Queue::Rules rules;
        rules[kRear].wait_us = std::llround(1e6 * wait_s);
        if (with_motion) rules[kMotion].wait_us = rules[kRear].wait_us;
        return rules;
      }()) {}

std::vector<Detections> RearJoiner::add_front(Detections detections, std::int64_t turn_us) {
  const std::int64_t utime = detections.utime;
  queue_.push(kFront, utime, {std::move(detections), turn_us});
  return release(false);
}

std::vector<Detections> RearJoiner::add_rear(Detections detections) {
  const std::int64_t utime = detections.utime;
  queue_.push(kRear, utime, {std::move(detections), 0});
  if (queue_.size(kRear) > kRearWaitingMax) queue_.take(kRear);
  return release(false);
}

std::vector<Detections> RearJoiner::add(const Motion& motion) {
  queue_.reach(kMotion, motion.utime);
  const auto after =
      std::upper_bound(motions_.begin(), motions_.end(), motion.utime,
                       [](std::int64_t utime, const Motion& other) { return utime < other.utime; });
  motions_.insert(after, motion);
  std::vector<Detections> decided = release(false);
  if (motions_.size() > kMotionsMax) motions_.pop_front();
  return decided;
}

/// The newest motion up to a time. Later ones are not used, because they may not have arrived.
std::optional<Motion> RearJoiner::motion_at(std::int64_t utime) const {
  const auto after =
      std::upper_bound(motions_.begin(), motions_.end(), utime,
                       [](std::int64_t time, const Motion& other) { return time < other.utime; });
  if (after == motions_.begin()) return std::nullopt;
  const Motion& motion = *(after - 1);
  if (utime - motion.utime > kMotionAgeMax_us) return std::nullopt;
  return motion;
}

std::vector<Detections> RearJoiner::flush() { return release(true); }

std::optional<std::int64_t> RearJoiner::waiting_utime() const {
  if (queue_.is_empty(kFront)) return std::nullopt;
  return queue_.front_utime(kFront);
}

std::vector<Detections> RearJoiner::release(bool flushing) {
  std::vector<Detections> decided;
  while (!queue_.is_empty(kFront)) {
    if (!flushing && queue_.blocker(queue_.front_utime(kFront))) break;
    decided.push_back(decide_front());
  }
  return decided;
}

Detections RearJoiner::decide_front() {
  Half front = queue_.take(kFront);
  Detections view = std::move(front.detections);
  while (!queue_.is_empty(kRear) && queue_.front_utime(kRear) < view.utime) queue_.take(kRear);
  const auto end_us = view.utime + std::llround(kTurnMargin * static_cast<double>(front.turn_us));
  if (queue_.is_empty(kRear) || queue_.front_utime(kRear) >= end_us) return view;
  const std::optional<Motion> motion = motion_at(view.utime);
  const std::size_t num_front = view.trunks.size();
  for (Detection& rear : queue_.take(kRear).detections.trunks) {
    set_range_and_bearing(rear, mount_);
    const auto end = view.trunks.begin() + static_cast<std::ptrdiff_t>(num_front);
    const auto same = std::find_if(view.trunks.begin(), end,
                                   [&](const Detection& d) { return is_same(d, rear, motion); });
    if (same == end) {
      view.trunks.push_back(rear);
    } else if (is_more_certain(rear, *same)) {
      *same = rear;
    }
  }
  std::stable_sort(
      view.trunks.begin(), view.trunks.end(),
      [](const Detection& a, const Detection& b) { return a.bearing_rad < b.bearing_rad; });
  return view;
}

}  // namespace orchard::detection
