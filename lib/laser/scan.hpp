// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/angles.hpp"

namespace orchard::laser {

/// Height of a scan's plane above the ground's plane, both as the robot's tilt tells them.
struct OverGround {
  float height_m = 0.0f;             ///< at the laser
  float per_x = 0.0f, per_y = 0.0f;  ///< its rise per metre along base's x and y
  /// Variance of the ground's height about its plane, at a distance from the robot.
  float held_m2 = 0.0f, per_m = 0.0f, per_m2 = 0.0f;

  /// derived: of the beams of thirty scans one is of ground that is so many sd above its plane.
  static constexpr float kGroundMax_sigma = 4.0f;

  bool is_known() const { return held_m2 > 0.0f; }
  float variance_m2(float distance_m) const {
    return held_m2 + distance_m * (per_m + distance_m * per_m2);
  }
  /// Whether a return there, from the laser along base's axes, may be of the ground.
  bool may_be_ground(float x_m, float y_m) const {
    const float there_m = height_m + per_x * x_m + per_y * y_m;
    return there_m < kGroundMax_sigma * std::sqrt(variance_m2(std::hypot(x_m, y_m)));
  }
};

/// One sweep of a 2D laser scanner in the laser frame (x forward, y left).
struct Scan {
  std::int64_t utime = 0;          ///< time of the first beam [us]
  std::int32_t seq = 0;            ///< +1 per scan of its source
  double bearing_min_rad = 0.0;    ///< bearing of ranges_m[0], counter-clockwise positive
  double bearing_step_rad = 0.0;   ///< between neighbouring beams; never 0
  double beam_period_us = 0.0;     ///< time between neighbouring beams [us]; 0 = unknown
  double range_min_m = 0.0;        ///< nearest valid return
  double range_max_m = 0.0;        ///< farthest valid return
  std::vector<float> ranges_m;     ///< one per beam; 0 = no return
  std::vector<float> intensities;  ///< empty, or one per beam

  /// Of the scan of a tilted robot that is projected to the horizontal plane (pose/attitude), not
  /// in scan_t: the bearings of the projected beams, else empty, where the tilt puts the laser
  /// beyond its mount, in base, what takes projected points back to the plane of the scan, which
  /// cameras are fixed to (laser frame), and the ground below, if the mount's height is known.
  std::vector<float> bearings_rad;
  double sway_x_m = 0.0;
  double sway_y_m = 0.0;
  Eigen::Matrix2d plane_of_level = Eigen::Matrix2d::Identity();
  OverGround over_ground;

  /// Bearing of a beam in the laser frame [rad]; `beam` may lie between two beams.
  double bearing_rad(double beam) const {
    if (!bearings_rad.empty()) return projected_bearing_rad(beam);
    return bearing_min_rad + beam * bearing_step_rad;
  }

  /// The beam whose bearing is nearest to `beam` equal steps from bearing_min_rad.
  std::size_t beam_near(std::size_t beam) const;

  bool has_intensities() const {
    return !intensities.empty() && intensities.size() == ranges_m.size();
  }

  /// Whether beam `i` has a return within the valid ranges.
  bool valid(std::size_t i) const {
    const double range_m = ranges_m[i];
    return range_m >= range_min_m && range_m <= range_max_m && range_m > 0.0;
  }

 private:
  double projected_bearing_rad(double beam) const {
    const double last = static_cast<double>(bearings_rad.size()) - 1.0;
    const double before = std::floor(std::max(0.0, std::min(beam, last)));
    return static_cast<double>(bearings_rad[static_cast<std::size_t>(before)]) +
           (beam - before) * bearing_step_rad;
  }
};

inline std::size_t Scan::beam_near(std::size_t beam) const {
  if (bearings_rad.empty()) return beam;
  const double wanted = static_cast<double>(beam),
               last = static_cast<double>(bearings_rad.size()) - 1;
  double near = wanted;
  for (int i = 0; i < 2; ++i) {  // bearings are turned by a few steps, smoothly
    const double steps = (bearing_rad(near) - bearing_min_rad) / bearing_step_rad;
    near = std::max(0.0, std::min(last, near + wanted - steps));
  }
  return static_cast<std::size_t>(std::lround(near));
}

/// A sweep of the second scanner, channel SCAN.rear. A separate type, so that the two scanners
/// cannot be confused.
struct RearScan : Scan {};

/// The fields of scan_t in the order of the wire; see bus/messages/fields.hpp.
struct ScanFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.stamp(m.utime, m.seq);
    v.count("num_ranges", m.ranges_m);
    v.count("num_intensities", m.intensities);
    v.field("bearing_min_rad", m.bearing_min_rad, -4 * geometry::kPi, 4 * geometry::kPi);
    v.field("bearing_step_rad", m.bearing_step_rad, -geometry::kPi, geometry::kPi);
    v.field("beam_period_us", m.beam_period_us, 0, 1e7);
    v.field("range_min_m", m.range_min_m, 0, 1e5);
    v.field("range_max_m", m.range_max_m, 0, 1e5);
    v.array("ranges_m", m.ranges_m, "num_ranges");
    v.array("intensities", m.intensities, "num_intensities");
  }
};

inline ScanFields fields_of(const Scan&) { return {}; }

}  // namespace orchard::laser
