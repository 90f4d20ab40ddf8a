// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scene/wheeled_body.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::simulation {
namespace {

constexpr double kGravity_mps2 = 9.80665;  ///< physical: standard gravity

/// derived: half of a hundredth of a second, what an inertial unit with a bandwidth of 100 Hz
/// resolves.
constexpr double kHalf_s = 0.005;

}  // namespace

Eigen::Isometry3d Pose3::transform() const {
  return Eigen::Translation3d(horizontal.x_m, horizontal.y_m, z_m) *
         Eigen::AngleAxisd(horizontal.yaw_rad, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitX());
}

WheeledBody::WheeledBody(const Terrain& terrain, const TerrainConfig& config)
    : terrain_(terrain),
      is_level_(config.is_flat()),
      wheelbase_m_(config.wheelbase_m),
      track_m_(config.track_m) {}

Pose3 WheeledBody::stand_at(const Pose2& T_map_base) const {
  if (is_level_) return {T_map_base};
  const auto wheel_z_m = [&](double ahead, double left) {
    const Eigen::Vector2d p =
        geometry::transform(T_map_base, {ahead * 0.5 * wheelbase_m_, left * 0.5 * track_m_});
    return terrain_.height_m(p.x(), p.y());
  };
  const double front_left_m = wheel_z_m(1, 1), front_right_m = wheel_z_m(1, -1);
  const double rear_left_m = wheel_z_m(-1, 1), rear_right_m = wheel_z_m(-1, -1);
  // The plane of least squares through the corners of a rectangle.
  const double sum_m = front_left_m + front_right_m + rear_left_m + rear_right_m;
  const double rise_ahead =
      (front_left_m + front_right_m - rear_left_m - rear_right_m) / (2.0 * wheelbase_m_);
  const double rise_left =
      (front_left_m + rear_left_m - front_right_m - rear_right_m) / (2.0 * track_m_);
  const double pitch_rad = -std::atan(rise_ahead);
  return {T_map_base, 0.25 * sum_m, pitch_rad, std::atan(rise_left * std::cos(pitch_rad))};
}

/// Arcs at constant speed: the centripetal acceleration is the only one.
BodyMotion WheeledBody::level_motion_at(const DrivePath& path, double time_s) const {
  const double yaw_rate_radps = path.yaw_rate_at(time_s);
  const bool drives = !path.carried_at(time_s) && time_s >= 0.0 && time_s < path.duration_s();
  const double left_mps2 = drives ? path.speed_mps() * yaw_rate_radps : 0.0;
  return {{0.0, 0.0, yaw_rate_radps}, {0.0, left_mps2, kGravity_mps2}};
}

BodyMotion WheeledBody::motion_at(const DrivePath& path, double time_s) const {
  if (is_level_) return level_motion_at(path, time_s);
  // The drive begins and ends at full speed: its ends are no jerks.
  const double now_s = std::clamp(time_s, kHalf_s, std::max(kHalf_s, path.duration_s() - kHalf_s));
  const auto at = [&](double s) { return stand_at(path.pose_at(s)).transform(); };
  const Eigen::Isometry3d before = at(now_s - kHalf_s), now = at(now_s),
                          after = at(now_s + kHalf_s);
  const Eigen::AngleAxisd turned(before.linear().transpose() * after.linear());
  Eigen::Vector3d force_mps2(0.0, 0.0, kGravity_mps2);
  if (!path.carried_at(now_s - kHalf_s) && !path.carried_at(now_s + kHalf_s)) {
    force_mps2 += (before.translation() - 2.0 * now.translation() + after.translation()) /
                  (kHalf_s * kHalf_s);
  }
  return {turned.angle() / (2.0 * kHalf_s) * turned.axis(), now.linear().transpose() * force_mps2};
}

}  // namespace orchard::simulation
