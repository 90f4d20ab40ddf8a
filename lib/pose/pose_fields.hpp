// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pose/measurement_fields.hpp"
#include "pose/pose_estimate.hpp"
#include "pose/trajectory.hpp"

namespace orchard::pose {

/// Limit of angles in (-pi, pi], plus a tolerance for rounding [rad].
inline constexpr double kHalfTurnMax_rad = geometry::kPi + 1e-9;

// Fields of each message in wire order, with their valid ranges; see bus/messages/fields.hpp.

struct PoseEstimateFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.stamp(m.utime, m.seq);
    v.field("x_m", m.x_m, -kCoordinateMax_m, kCoordinateMax_m);
    v.field("y_m", m.y_m, -kCoordinateMax_m, kCoordinateMax_m);
    v.field("yaw_rad", m.yaw_rad, -kHalfTurnMax_rad, kHalfTurnMax_rad);
    v.field("pitch_rad", m.pitch_rad, -kHalfTurnMax_rad, kHalfTurnMax_rad);
    v.field("roll_rad", m.roll_rad, -kHalfTurnMax_rad, kHalfTurnMax_rad);
    v.covariance("covariance", m.covariance);
  }
};

/// Fields of trajectory_pose_t: a pose without seq, pitch and roll.
struct TrajectoryPoseFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.time("utime", m.utime);
    v.field("x_m", m.x_m, -kCoordinateMax_m, kCoordinateMax_m);
    v.field("y_m", m.y_m, -kCoordinateMax_m, kCoordinateMax_m);
    v.field("yaw_rad", m.yaw_rad, -kHalfTurnMax_rad, kHalfTurnMax_rad);
    v.covariance("covariance", m.covariance);
  }
};

struct TrajectoryPageFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.stamp(m.utime, m.seq);
    v.count("num_poses", m.poses);
    v.field("revision", m.revision, 1, INT32_MAX);
    v.field("page", m.page, 0, INT32_MAX);
    v.field("num_pages", m.num_pages, 1, INT32_MAX);
    v.items("poses", m.poses, "num_poses", TrajectoryPoseFields{});
  }
};

inline PoseEstimateFields fields_of(const PoseEstimate&) { return {}; }
inline TrajectoryPageFields fields_of(const TrajectoryPage&) { return {}; }

}  // namespace orchard::pose
