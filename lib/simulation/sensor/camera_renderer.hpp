// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "simulation/random.hpp"
#include "simulation/scene/scene.hpp"
#include "simulation/sensor/lighting.hpp"
#include "simulation/simulation_config.hpp"
#include "vision/image.hpp"

namespace orchard::simulation {

/// A picture in memory: rows of blue-green-red pixels.
struct Picture {
  int width_px = 0;
  int height_px = 0;
  std::vector<float> bgr;  ///< 3 x width x height
};

/// Time of an exposure and the robot's yaw rate.
struct Exposure {
  double time_s = 0.0;  ///< of the run
  double yaw_rate_radps = 0.0;
};

/// Renders a world for a rig's camera: one ray per pixel through the inverse of the lens
/// distortion; edges are blended by the covered fraction of the pixel.
class CameraRenderer {
 public:
  static constexpr float kNearest_m = 0.05f;
  static constexpr float kFarthest_m = 40.0f;  ///< beyond, trunks are 1 or 2 pixels wide
  static constexpr float kUprightSky = 0.62f;  ///< fraction of sky light on upright surfaces: half
                                               ///< of the sky, and some light from the ground

  explicit CameraRenderer(const RigConfig& rig);

  /// Computes the shadows of a static world if `simulation.light` enables them.
  void cast_shadows(const World& world);

  /// Renders without noise and blur, at the robot's pose T_map_base. Stored values (0 to 255), or
  /// linear light when `simulation.light` is enabled.
  Picture draw(const World& world, const Pose2& T_map_base, const Exposure& exposure = {}) const;

  /// Renders the sensor's picture as JPEG. Leaves utime and seq 0.
  vision::Image take(const World& world, const Pose2& T_map_base, Random& random,
                     const Exposure& exposure = {}) const;

 private:
  /// A pixel's ray in base: unit length in the plane, so that distance is horizontal distance.
  struct Ray {
    float x = 0.0f;
    float y = 0.0f;
    float slope = 0.0f;
    float width_rad = 0.0f;     ///< angular width of the pixel
    float slope_height = 0.0f;  ///< extent of the pixel in slope
  };
  struct Column {
    float azimuth_min_rad = 0.0f;
    float azimuth_max_rad = 0.0f;
  };

  /// Data shared by all shapes of one picture.
  struct Frame {
    const World& world;
    Pose2 T_map_camera;
    const Lighting* lighting;   ///< null: simple shading
    float sun_x, sun_y, sun_z;  ///< direction to the sun in base axes
    Picture& picture;
  };

  /// A point relative to the camera's foot, in base axes; its azimuth is relative to axis_rad_.
  struct Bearing {
    float x_m, y_m, distance_m, azimuth_rad;
  };
  Bearing bearing_of(const Pose2& T_map_camera, double x_m, double y_m) const;

  /// Calls `function(ray, pixel)` for all pixels of the columns within an angle of an azimuth.
  template <class Function>
  void for_each_ray(float azimuth_rad, float half_rad, Function function) const;

  /// Light from a surface at a point relative to the camera's foot; `facing` as in Lighting.
  Bgr lit(const Frame& frame, const Bgr& colour, float facing, const Eigen::Vector3f& p,
          int target) const;
  void draw_background(const Frame& frame) const;
  void draw_cylinder(const Frame& frame, const Cylinder& cylinder) const;
  void draw_box(const Frame& frame, const Box& box) const;
  void draw_crown(const Frame& frame, const Crown& crown) const;
  float open(const Frame& frame, float x_m, float y_m, float z_m, int target) const;
  void respond(const Lighting& lighting, const Exposure& exposure, Picture& picture) const;
  static void blend(Picture& picture, std::size_t pixel, const Bgr& colour, float fraction);
  double sun_azimuth_rad(const World& world) const;
  double sun_elevation_rad(const World& world) const;

  RigConfig rig_;
  int width_px_ = 0;
  int height_px_ = 0;
  double camera_x_m_ = 0.0;  ///< in base
  double camera_y_m_ = 0.0;
  double camera_height_m_ = 0.0;  ///< above the ground
  double axis_rad_ = 0.0;         ///< azimuth of the picture's centre in base
  std::vector<Ray> rays_;
  ShadowMap shadows_;
  std::vector<Column> columns_;  ///< azimuths relative to axis_rad_
};

}  // namespace orchard::simulation
