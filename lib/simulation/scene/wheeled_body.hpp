// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include "simulation/scene/drive_path.hpp"
#include "simulation/scene/terrain.hpp"

namespace orchard::simulation {

/// T_map_base in space: a horizontal pose, the height of base, and its attitude (yaw about z, then
/// pitch about y, nose down positive, then roll about x, left side up positive).
struct Pose3 {
  Pose2 horizontal;
  double z_m = 0.0;
  double pitch_rad = 0.0;
  double roll_rad = 0.0;

  Eigen::Isometry3d transform() const;
};

/// What an inertial unit at base would measure without errors, in base.
struct BodyMotion {
  Eigen::Vector3d angular_rate_radps;
  Eigen::Vector3d specific_force_mps2;  ///< (0, 0, +9.8) at rest on level ground
};

/// A body on four wheels that follow the ground: its plane is the one that fits their contacts
/// best, and its origin is above the middle between them.
class WheeledBody {
 public:
  /// A body on level ground.
  WheeledBody() = default;

  WheeledBody(const Terrain& terrain, const TerrainConfig& config);

  /// The pose of base that stands on the ground at a horizontal pose.
  Pose3 stand_at(const Pose2& T_map_base) const;

  /// The motion at a time of a drive along a path; lifted: without acceleration.
  BodyMotion motion_at(const DrivePath& path, double time_s) const;

  bool is_level() const { return is_level_; }
  const Terrain& terrain() const { return terrain_; }

 private:
  BodyMotion level_motion_at(const DrivePath& path, double time_s) const;

  Terrain terrain_;
  bool is_level_ = true;
  double wheelbase_m_ = 1.0;
  double track_m_ = 1.0;
};

}  // namespace orchard::simulation
