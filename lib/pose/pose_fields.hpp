// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "geometry/angles.hpp"
#include "pose/measurements.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::pose {

/// Limit of accepted coordinates [m]. physical: larger than any projected coordinate on Earth.
inline constexpr double kCoordinateMax_m = 1e8;

// Fields of each message in wire order, with their valid ranges; see bus/messages/fields.hpp.

struct OdometryFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.stamp(m.utime, m.seq);
    v.field("speed_mps", m.speed_mps, -1000, 1000);
    v.field("yaw_rate_radps", m.yaw_rate_radps, -1000, 1000);
    v.covariance("covariance", m.covariance);
  }
};

struct GnssFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.stamp(m.utime, m.seq);
    v.field("latitude_deg", m.latitude_deg, -90, 90);
    v.field("longitude_deg", m.longitude_deg, -180, 180);
    v.field("altitude_m", m.altitude_m, -12000, 100000);
    v.covariance("covariance", m.covariance);
    v.field("fix_quality", m.fix_quality, 0, 9);
  }
};

struct PoseFixFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.stamp(m.utime, m.seq);
    v.field("x_m", m.x_m, -kCoordinateMax_m, kCoordinateMax_m);
    v.field("y_m", m.y_m, -kCoordinateMax_m, kCoordinateMax_m);
    v.field("yaw_rad", m.yaw_rad, -4 * geometry::kPi, 4 * geometry::kPi);
    v.covariance("covariance", m.covariance);
    v.field("has_yaw", m.has_yaw, 0, 1);
  }
};

struct ImuFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.stamp(m.utime, m.seq);
    v.field("angular_rate_radps", m.angular_rate_radps, -1e3, 1e3);
    v.field("acceleration_mps2", m.acceleration_mps2, -1e4, 1e4);
    v.field("angular_rate_variance", m.angular_rate_variance, 0, 1e6);
    v.field("acceleration_variance", m.acceleration_variance, 0, 1e8);
    v.field("roll_rad", m.roll_rad, -4 * geometry::kPi, 4 * geometry::kPi);
    v.field("pitch_rad", m.pitch_rad, -4 * geometry::kPi, 4 * geometry::kPi);
    v.field("yaw_rad", m.yaw_rad, -4 * geometry::kPi, 4 * geometry::kPi);
    v.field("orientation_variance", m.orientation_variance, 0, 1e3);
    v.field("has_orientation", m.has_orientation, 0, 1);
  }
};

inline OdometryFields fields_of(const Odometry&) { return {}; }
inline GnssFields fields_of(const Gnss&) { return {}; }
inline PoseFixFields fields_of(const PoseFix&) { return {}; }
inline ImuFields fields_of(const Imu&) { return {}; }

/// Limit of angles in (-pi, pi] [rad]; derived: with a tolerance for rounding.
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
