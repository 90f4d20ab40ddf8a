// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "simulation/scene/scene.hpp"

namespace orchard::simulation {

/// A colour, blue-green-red, 0 to 255 each.
struct Bgr {
  float b = 0.0f;
  float g = 0.0f;
  float r = 0.0f;
};

inline Bgr operator*(const Bgr& c, float f) { return {c.b * f, c.g * f, c.r * f}; }
inline Bgr mix(const Bgr& a, const Bgr& b, float fraction_of_b) {
  return {a.b + (b.b - a.b) * fraction_of_b, a.g + (b.g - a.g) * fraction_of_b,
          a.r + (b.r - a.r) * fraction_of_b};
}

/// Converts hue [deg], saturation and value in [0, 1] to a colour.
Bgr from_hsv(double hue_deg, double saturation, double value);

/// Smooth, aperiodic noise in [-1, 1] on an integer lattice.
float value_noise(float x, float y, std::uint32_t seed);

/// Colour of the ground at a point of the map; `footprint_m` is the extent of one pixel there.
Bgr ground_colour(const World& world, float x_m, float y_m, float footprint_m);

/// Colour of the far background in a direction; slope is rise over horizontal distance.
Bgr backdrop_colour(const World& world, float azimuth_rad, float slope);

/// Slope of the horizon for a camera at a height: the ground is below it, the background above.
float horizon_slope(const World& world, float camera_height_m);

/// Colour of a cylinder's surface before lighting, at an angle around it [rad] and a height above
/// its foot; `base` is from_hsv of its appearance.
Bgr surface_colour(const Appearance& appearance, const Bgr& base, float angle_rad, float radius_m,
                   float height_m, float footprint_m);

}  // namespace orchard::simulation
