// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/drive_path.hpp"

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

Pose2 compose(const Pose2& T_a_b, const Pose2& T_b_c) {
  const double c = std::cos(T_a_b.yaw_rad), s = std::sin(T_a_b.yaw_rad);
  return {T_a_b.x_m + c * T_b_c.x_m - s * T_b_c.y_m, T_a_b.y_m + s * T_b_c.x_m + c * T_b_c.y_m,
          geometry::wrap_angle_rad(T_a_b.yaw_rad + T_b_c.yaw_rad)};
}

DrivePath::DrivePath(const Pose2& start, double speed_mps) : start_(start), speed_mps_(speed_mps) {}

void DrivePath::append(double length_m, double curvature_per_m) {
  pieces_.push_back({pose_at_length(length_m_), length_m_, curvature_per_m});
  length_m_ += length_m;
}

Pose2 DrivePath::pose_at_length(double s_m) const {
  if (pieces_.empty()) return start_;
  const double s = std::clamp(s_m, 0.0, length_m_);
  const auto after =
      std::upper_bound(pieces_.begin(), pieces_.end(), s,
                       [](double value, const Piece& p) { return value < p.begin_m; });
  const Piece& piece = *std::prev(after);
  return follow(piece.start, s - piece.begin_m, piece.curvature_per_m);
}

Pose2 DrivePath::pose_at(double time_s) const { return pose_at_length(time_s * speed_mps_); }

}  // namespace orchard::simulation
