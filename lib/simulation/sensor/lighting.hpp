// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "simulation/scene/scene.hpp"
#include "simulation/simulation_config.hpp"
#include "simulation/texture.hpp"

namespace orchard::simulation {

/// Blue, green and red gains, with green 1, of light of `temperature_k` in a camera whose white
/// balance is set for `white_balance_k`. Ratio of black bodies by Planck's law at 450, 540 and 610
/// nm, near the peaks of the Bayer filters of small sensors.
std::array<double, 3> light_gains(double temperature_k, double white_balance_k);

/// The light of a run relative to its start [EV], and its colour temperature [K].
double light_ev(const LightConfig& light, double time_s);
double light_temperature_k(const LightConfig& light, double time_s);

/// Converts a stored value to linear light (both 0 to 255), with a gamma of 2.2.
float linear_of(float stored);
inline Bgr linear_of(const Bgr& c) { return {linear_of(c.b), linear_of(c.g), linear_of(c.r)}; }

/// Sun, sky and camera at one moment of a run: converts the linear light of a surface under white
/// light to the light that the sensor collects.
class Lighting {
 public:
  Lighting(const LightConfig& light, const CameraResponseConfig& response, double time_s);

  /// Linear light from a surface. `facing`: cosine between its normal and the sun (0 when turned
  /// away); `open`: fraction of the sun that reaches it; `sky`: visible fraction of the sky.
  Bgr shade(const Bgr& albedo, float facing, float open, float sky) const {
    const float direct = sun_fraction_ * facing * open, around = (1.0f - sun_fraction_) * sky;
    return {albedo.b * (direct * sun_.b + around * sky_.b),
            albedo.g * (direct * sun_.g + around * sky_.g),
            albedo.r * (direct * sun_.r + around * sky_.r)};
  }
  /// Light from the sky and the far background.
  Bgr emit(const Bgr& c) const { return {c.b * sky_.b, c.g * sky_.g, c.r * sky_.r}; }

  /// Converts linear light at a position of the picture to a stored value, 0 to 255; clips.
  /// `corner` is the squared distance from the centre, 1 in the corners.
  Bgr store(const Bgr& light, float corner) const;

  double exposure_gain() const { return gain_; }

 private:
  float store(float light) const;

  float sun_fraction_;
  Bgr sun_, sky_;  ///< gains
  float gain_ = 1.0f;
  float vignetting_;
  std::array<float, 4097> curve_{};
};

/// Shadow map of a static world.
///
/// A grid over the ground: each cell stands for the line from it towards the sun, and stores the
/// fraction that crowns leave open and the height up to which a solid object blocks it. Swaying and
/// moving objects cast no shadow.
class ShadowMap {
 public:
  ShadowMap() = default;
  ShadowMap(const World& world, double sun_azimuth_rad, double sun_elevation_rad);

  /// Fraction of the sun that reaches a point of the map, [0, 1]. `target` casts no shadow on
  /// itself.
  float open(float x_m, float y_m, float z_m, int target) const;

  bool empty() const { return cells_.empty(); }

 private:
  struct Cell {
    float crown = 1.0f;  ///< fraction that crowns leave open
    float top_m = -1.0f;
    int target = -2;
  };

  void add(const Cylinder& cylinder);
  void add(const Box& box);
  void add(const Crown& crown);
  /// Adds the shadow of one upright line.
  void add_line(double x_m, double y_m, double base_m, double top_m, int target);
  Cell* at(double x_m, double y_m);

  double x_min_m_ = 0.0, y_min_m_ = 0.0;
  int num_x_ = 0, num_y_ = 0;
  double towards_x_ = 1.0, towards_y_ = 0.0;  ///< the sun's direction in the plane
  double cotangent_ = 1.0;                    ///< ratio of shadow length to height
  double sine_ = 1.0;
  std::vector<Cell> cells_;
};

}  // namespace orchard::simulation
