// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/pose2.hpp"

namespace orchard::simulation {

using geometry::Pose2;

/// A path of straight lines and arcs driven at constant speed, with at most one jump: the robot is
/// lifted, carried through the air and set down elsewhere on the path.
class DrivePath {
 public:
  DrivePath() = default;
  DrivePath(const Pose2& start, double speed_mps);

  /// Appends an arc; curvature is positive to the left, 0 for a straight line.
  void append(double length_m, double curvature_per_m);

  /// Restricts the drive to the part from `begin_m` to `end_m` of the path.
  void drive_only(double begin_m, double end_m);

  /// Lifts the robot at a time of the drive and sets it down `for_s` later at `to_m` of the path.
  void carry(double at_s, double for_s, double to_m);

  double length_m() const { return length_m_; }  ///< of the whole path
  double duration_s() const;
  double speed_mps() const { return speed_mps_; }

  /// T_map_base; before the start and after the end the robot stands still.
  Pose2 pose_at(double time_s) const;

  /// True if the wheels are off the ground.
  bool carried_at(double time_s) const;

  /// Position of the robot along the path; while it is carried, the position where it was lifted
  /// [m].
  double way_at(double time_s) const;

  /// True yaw rate at a time [rad/s].
  double yaw_rate_at(double time_s) const;

 private:
  struct Piece {
    Pose2 start;
    double begin_m;
    double curvature_per_m;
  };
  struct Leap {
    double at_s = 0.0;
    double for_s = 0.0;
    double to_m = 0.0;
  };
  std::size_t piece_of(double s_m) const;
  Pose2 pose_at_length(double s_m) const;
  bool has_leap() const { return leap_.for_s > 0.0; }

  Pose2 start_;
  double speed_mps_ = 0.0;
  double length_m_ = 0.0;
  double begin_m_ = 0.0;
  double end_m_ = 0.0;
  Leap leap_;
  std::vector<Piece> pieces_;
};

}  // namespace orchard::simulation
