// SPDX-License-Identifier: BSD-3-Clause
#include "pose/attitude/levelled_scan.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "geometry/pose2.hpp"
#include "geometry/statistics.hpp"

namespace orchard::pose {
namespace {

// derived: a return lower than this is taken for the ground, one in 40 of which is higher; a
// surface that begins so low is ground up to OverGround::kGroundMax_sigma.
constexpr float kGround_sigma = 2.0f;
// derived: a beam without a return says nothing beyond half the scanner's range (see FreeSpace).
constexpr float kNoReturnSays = 0.5f;

}  // namespace

ScanLeveller::Height ScanLeveller::height_of(float height_m, float variance_m2) {
  const float height2_m2 = height_m > 0.0f ? height_m * height_m : 0.0f;
  if (height2_m2 < kGround_sigma * kGround_sigma * variance_m2) return Height::kGround;
  const bool is_low =
      height2_m2 < geometry::square(laser::OverGround::kGroundMax_sigma) * variance_m2;
  return is_low ? Height::kLow : Height::kHigh;
}

void ScanLeveller::set_directions(const laser::Scan& scan) {
  const auto num = static_cast<Eigen::Index>(scan.ranges_m.size());
  if (bearings_rad_.size() == num && bearing_min_rad_ == scan.bearing_min_rad &&
      bearing_step_rad_ == scan.bearing_step_rad) {
    return;
  }
  bearing_min_rad_ = scan.bearing_min_rad;
  bearing_step_rad_ = scan.bearing_step_rad;
  for (Eigen::ArrayXf* array : {&bearings_rad_, &part_, &x_, &y_, &level_x_, &level_y_, &rise_}) {
    array->resize(num);
  }
  for (Eigen::Index i = 0; i < num; ++i) {
    const double bearing_rad = bearing_min_rad_ + static_cast<double>(i) * bearing_step_rad_;
    bearings_rad_(i) = static_cast<float>(bearing_rad);
    part_(i) = static_cast<float>(i) / static_cast<float>(std::max<Eigen::Index>(1, num - 1));
    x_(i) = static_cast<float>(std::cos(mount_.mount_yaw_rad + bearing_rad));
    y_(i) = static_cast<float>(std::sin(mount_.mount_yaw_rad + bearing_rad));
  }
}

void ScanLeveller::level(laser::Scan& scan, const Attitude& first, const Attitude& last,
                         const GroundPlane& ground) {
  set_directions(scan);
  const Eigen::Matrix3d R_first = R_level_base(first), R_last = R_level_base(last);
  const Eigen::Vector3d mount(mount_.mount_x_m, mount_.mount_y_m, mount_.height_m);
  const Eigen::Vector3d laser = 0.5 * (R_first + R_last) * mount;
  scan.sway_x_m = laser.x() - mount.x();
  scan.sway_y_m = laser.y() - mount.y();
  // The rotation is nearly linear in the tilt of a sweep.
  const Eigen::Matrix3f R = R_first.cast<float>(), change = (R_last - R_first).cast<float>();
  const auto turned = [&](int row, Eigen::ArrayXf& to) {
    to = R(row, 0) * x_ + R(row, 1) * y_ + part_ * (change(row, 0) * x_ + change(row, 1) * y_);
  };
  turned(0, level_x_);
  turned(1, level_y_);
  turned(2, rise_);
  const Eigen::Matrix2d mount_yaw = geometry::rotation(mount_.mount_yaw_rad);
  scan.plane_of_level = mount_yaw.transpose() * R_first.topLeftCorner<2, 2>().inverse() * mount_yaw;
  const Eigen::Vector2f gradient = ground.gradient().cast<float>();
  rise_ -= gradient.x() * level_x_ + gradient.y() * level_y_;
  scan.bearings_rad.resize(scan.ranges_m.size());
  Eigen::Map<Eigen::ArrayXf> bearings_rad(scan.bearings_rad.data(), bearings_rad_.size());
  // The arc tangent of a small turn, as exact as a float at the steepest tilt that is levelled.
  bearings_rad = (x_ * level_y_ - y_ * level_x_) / (x_ * level_x_ + y_ * level_y_);
  bearings_rad *= 1.0f - bearings_rad.square() * (1.0f / 3.0f - bearings_rad.square() / 5.0f);
  bearings_rad += bearings_rad_;
  level_x_ = (level_x_.square() + level_y_.square()).sqrt();
  const Eigen::Matrix3d R_middle = 0.5 * (R_first + R_last);
  const Eigen::Vector2d rise = R_middle.topLeftCorner<2, 2>().transpose().inverse() *
                               R_middle.bottomLeftCorner<1, 2>().transpose();
  const laser::OverGround below =
      ground.below(laser.z() - ground.gradient().dot(laser.head<2>()), rise);
  set_ranges(scan, below);
  if (mount_.height_m <= 0.0) return;
  scan.over_ground = below;
  leave_out_ground(scan);
}

/// Makes ranges horizontal and finds the heights of the returns above the ground's plane.
void ScanLeveller::set_ranges(laser::Scan& scan, const laser::OverGround& ground) {
  const auto nearest_m = static_cast<float>(scan.range_min_m);
  const auto farthest_m = static_cast<float>(scan.range_max_m);
  const float no_return_m = kNoReturnSays * farthest_m;
  heights_.resize(scan.ranges_m.size());
  for (std::size_t i = 0; i < heights_.size(); ++i) {
    const auto beam = static_cast<Eigen::Index>(i);
    const float range_m = scan.ranges_m[i];
    const bool returns = range_m >= nearest_m && range_m < farthest_m && range_m > 0.0f;
    const float at_m = returns ? range_m : no_return_m;
    const float level_m = level_x_(beam) * at_m;
    heights_[i] = height_of(ground.height_m + at_m * rise_(beam), ground.variance_m2(level_m));
    if (returns) scan.ranges_m[i] = level_m;
  }
}

/// Marks the returns of the ground as not measured, and of the surfaces that they are part of.
void ScanLeveller::leave_out_ground(laser::Scan& scan) {
  const auto has = [&](Height height) {
    return std::find(heights_.begin(), heights_.end(), height) != heights_.end();
  };
  if (!has(Height::kGround)) return;
  const auto spread = [&](std::size_t from, std::size_t to) {
    if (heights_[from] != Height::kGround || heights_[to] != Height::kLow) return;
    if (!scan.valid(from) || !scan.valid(to)) return;
    const double a_m = scan.ranges_m[from], b_m = scan.ranges_m[to];
    if (std::abs(a_m - b_m) > jump_m_ + jump_fraction_ * std::min(a_m, b_m)) return;
    heights_[to] = Height::kGround;
  };
  if (has(Height::kLow)) {
    for (std::size_t i = 1; i < heights_.size(); ++i) spread(i - 1, i);
    for (std::size_t i = heights_.size(); i-- > 1;) spread(i, i - 1);
  }
  for (std::size_t i = 0; i < heights_.size(); ++i) {
    if (heights_[i] != Height::kGround) continue;
    scan.ranges_m[i] = std::numeric_limits<float>::quiet_NaN();
  }
}

}  // namespace orchard::pose
