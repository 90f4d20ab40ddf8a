// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace orchard::simulation {

/// A pose in the plane, T_map_base unless its name says otherwise.
struct Pose2 {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
};

/// `a` followed by `b` (T_a_c = T_a_b T_b_c).
Pose2 compose(const Pose2& T_a_b, const Pose2& T_b_c);

/// Straight lines and arcs driven one after the other at one speed.
class DrivePath {
 public:
  DrivePath() = default;
  DrivePath(const Pose2& start, double speed_mps);

  /// Appends an arc; curvature is positive to the left, 0 for a straight line.
  void append(double length_m, double curvature_per_m);

  double length_m() const { return length_m_; }
  double duration_s() const { return speed_mps_ > 0.0 ? length_m_ / speed_mps_ : 0.0; }
  double speed_mps() const { return speed_mps_; }

  /// T_map_base; before the start and after the end the robot stands still.
  Pose2 pose_at(double time_s) const;

 private:
  struct Piece {
    Pose2 start;
    double begin_m;
    double curvature_per_m;
  };
  Pose2 pose_at_length(double s_m) const;

  Pose2 start_;
  double speed_mps_ = 0.0;
  double length_m_ = 0.0;
  std::vector<Piece> pieces_;
};

}  // namespace orchard::simulation
