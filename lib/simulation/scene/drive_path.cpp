// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scene/drive_path.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"

namespace orchard::simulation {
namespace {

Pose2 follow(const Pose2& start, double s_m, double curvature_per_m) {
  const double turn_rad = s_m * curvature_per_m;
  if (std::abs(turn_rad) < 1e-12) {
    return compose(start, {s_m, 0.0, turn_rad});
  }
  return compose(start, {std::sin(turn_rad) / curvature_per_m,
                         (1.0 - std::cos(turn_rad)) / curvature_per_m, turn_rad});
}

}  // namespace

DrivePath::DrivePath(const Pose2& start, double speed_mps) : start_(start), speed_mps_(speed_mps) {}

void DrivePath::append(double length_m, double curvature_per_m) {
  pieces_.push_back({pose_at_length(length_m_), length_m_, curvature_per_m});
  length_m_ += length_m;
  end_m_ = length_m_;
}

void DrivePath::drive_only(double begin_m, double end_m) {
  begin_m_ = begin_m;
  end_m_ = end_m;
}

void DrivePath::carry(double at_s, double for_s, double to_m) { leap_ = {at_s, for_s, to_m}; }

double DrivePath::duration_s() const {
  if (speed_mps_ <= 0.0) return 0.0;
  const double plain_s = (end_m_ - begin_m_) / speed_mps_;
  if (!has_leap() || leap_.at_s >= plain_s) return plain_s;
  return leap_.at_s + leap_.for_s + (end_m_ - leap_.to_m) / speed_mps_;
}

double DrivePath::way_at(double time_s) const {
  double s_m = begin_m_ + time_s * speed_mps_;
  if (has_leap() && time_s > leap_.at_s) {
    const double landed_s = time_s - leap_.at_s - leap_.for_s;
    s_m = landed_s < 0.0 ? begin_m_ + leap_.at_s * speed_mps_ : leap_.to_m + landed_s * speed_mps_;
  }
  return std::clamp(s_m, begin_m_, end_m_);
}

bool DrivePath::carried_at(double time_s) const {
  return has_leap() && time_s > leap_.at_s && time_s < leap_.at_s + leap_.for_s;
}

std::size_t DrivePath::piece_of(double s_m) const {
  const auto after =
      std::upper_bound(pieces_.begin(), pieces_.end(), s_m,
                       [](double value, const Piece& p) { return value < p.begin_m; });
  return static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, after - pieces_.begin() - 1));
}

Pose2 DrivePath::pose_at_length(double s_m) const {
  if (pieces_.empty()) return start_;
  const Piece& piece = pieces_[piece_of(s_m)];
  return follow(piece.start, s_m - piece.begin_m, piece.curvature_per_m);
}

Pose2 DrivePath::pose_at(double time_s) const {
  if (!carried_at(time_s)) return pose_at_length(way_at(time_s));
  const Pose2 from = pose_at_length(begin_m_ + leap_.at_s * speed_mps_);
  const Pose2 to = pose_at_length(leap_.to_m);
  const double u = (time_s - leap_.at_s) / leap_.for_s;
  const double fraction = u * u * (3.0 - 2.0 * u);  // smooth at both ends
  return {from.x_m + fraction * (to.x_m - from.x_m), from.y_m + fraction * (to.y_m - from.y_m),
          geometry::wrap_angle_rad(from.yaw_rad +
                                   fraction * geometry::wrap_angle_rad(to.yaw_rad - from.yaw_rad))};
}

double DrivePath::yaw_rate_at(double time_s) const {
  if (carried_at(time_s)) {
    constexpr double kHalf_s = 1e-3;
    return geometry::wrap_angle_rad(pose_at(time_s + kHalf_s).yaw_rad -
                                    pose_at(time_s - kHalf_s).yaw_rad) /
           (2.0 * kHalf_s);
  }
  if (pieces_.empty() || time_s < 0.0 || time_s > duration_s()) return 0.0;
  return speed_mps_ * pieces_[piece_of(way_at(time_s))].curvature_per_m;
}

}  // namespace orchard::simulation
