// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "simulation/random.hpp"
#include "simulation/scene.hpp"
#include "simulation/tube_scene.hpp"
#include "vision/image.hpp"

namespace orchard::simulation {

/// A picture in memory: rows of blue-green-red pixels.
struct Picture {
  int width_px = 0;
  int height_px = 0;
  std::vector<float> bgr;  ///< 3 x width x height
};

/// Draws worlds as a rig's camera sees them: one ray per pixel through the inverse of the lens
/// distortion, edges blended by the share of the pixel that they cover.
class CameraRenderer {
 public:
  explicit CameraRenderer(const RigConfig& rig);

  /// Without noise and blur. T_map_base: where the robot is.
  Picture draw(const World& world, const Pose2& T_map_base) const;

  /// The picture a sensor makes of it, as JPEG. Leaves utime and seq 0.
  vision::Image take(const World& world, const Pose2& T_map_base, Random& random) const;

 private:
  /// A pixel's ray in base: unit length in the plane, so that distance is horizontal distance.
  struct Ray {
    float x = 0.0f;
    float y = 0.0f;
    float slope = 0.0f;
    float width_rad = 0.0f;     ///< bearing that the pixel covers
    float slope_height = 0.0f;  ///< slope that the pixel covers
  };
  struct Column {
    float azimuth_min_rad = 0.0f;
    float azimuth_max_rad = 0.0f;
  };

  void draw_background(const World& world, const Pose2& T_map_camera, Picture& picture) const;
  void draw_cylinder(const World& world, const Cylinder& cylinder, const Pose2& T_map_camera,
                     Picture& picture) const;
  const Ray& ray(int u, int v) const { return rays_[static_cast<std::size_t>(v) * width_px_ + u]; }

  RigConfig rig_;
  int width_px_ = 0;
  int height_px_ = 0;
  double camera_x_m_ = 0.0;  ///< in base
  double camera_y_m_ = 0.0;
  double camera_height_m_ = 0.0;  ///< above the ground
  double axis_rad_ = 0.0;         ///< azimuth of the picture's middle in base
  std::vector<Ray> rays_;
  std::vector<Column> columns_;  ///< azimuths relative to axis_rad_
};

}  // namespace orchard::simulation
