// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/texture.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::simulation {
namespace {

constexpr float kPlates = 0.95f;
constexpr float kWallDistance_m = 14.0f;  ///< of the laboratory, beyond the scanner's range

float lattice(std::int32_t x, std::int32_t y, std::uint32_t seed) {
  std::uint32_t h = static_cast<std::uint32_t>(x) * 0x8da6b343u ^
                    static_cast<std::uint32_t>(y) * 0xd8163841u ^ seed * 0xcb1ab31fu;
  h = (h ^ (h >> 15)) * 0x2c1b3c6du;
  h = (h ^ (h >> 12)) * 0x297a2d39u;
  h ^= h >> 15;
  return static_cast<float>(h >> 8) * (2.0f / 16777216.0f) - 1.0f;
}

/// Remaining contrast of a pattern when a pixel covers `footprint_m` of it.
float visible(float footprint_m, float size_m) {
  return 1.0f / (1.0f + 2.0f * footprint_m / size_m);
}

}  // namespace

Bgr from_hsv(double hue_deg, double saturation, double value) {
  const auto channel = [&](double n) {
    const double k = std::fmod(n + hue_deg / 60.0 + 6.0, 6.0);
    const double fraction = std::clamp(std::min(k, 4.0 - k), 0.0, 1.0);
    return static_cast<float>(255.0 * (value - value * saturation * fraction));
  };
  return {channel(1.0), channel(3.0), channel(5.0)};
}

float value_noise(float x, float y, std::uint32_t seed) {
  const float fx = std::floor(x), fy = std::floor(y);
  const auto ix = static_cast<std::int32_t>(fx), iy = static_cast<std::int32_t>(fy);
  float u = x - fx, v = y - fy;
  u = u * u * (3.0f - 2.0f * u);
  v = v * v * (3.0f - 2.0f * v);
  const float low = lattice(ix, iy, seed) * (1.0f - u) + lattice(ix + 1, iy, seed) * u;
  const float high = lattice(ix, iy + 1, seed) * (1.0f - u) + lattice(ix + 1, iy + 1, seed) * u;
  return low * (1.0f - v) + high * v;
}

Bgr ground_colour(const World& world, float x_m, float y_m, float footprint_m) {
  const std::uint32_t seed = world.texture_seed;
  const float fine = value_noise(x_m * 40.0f, y_m * 40.0f, seed) * visible(footprint_m, 0.025f);
  const float medium = value_noise(x_m * 8.0f, y_m * 8.0f, seed + 1) * visible(footprint_m, 0.12f);
  const float coarse = value_noise(x_m * 1.1f, y_m * 1.1f, seed + 2);
  if (world.indoors) {
    const Bgr floor{104.0f, 116.0f, 106.0f};  // a grey-green carpet
    return floor * (1.0f + 0.10f * fine + 0.07f * medium + 0.05f * coarse);
  }
  const Bgr grass{52.0f, 112.0f, 84.0f}, soil{74.0f, 100.0f, 118.0f};
  const float bare = std::clamp(0.35f + 0.5f * coarse + 0.4f * medium, 0.0f, 1.0f);
  return mix(grass, soil, bare) * (1.0f + 0.22f * fine + 0.12f * medium);
}

Bgr backdrop_colour(const World& world, float azimuth_rad, float slope) {
  const std::uint32_t seed = world.texture_seed + 17;
  if (world.indoors) {
    // a pale bluish wall with a darker skirting and broad panels
    const Bgr wall{172.0f, 166.0f, 158.0f};
    const float panel = value_noise(azimuth_rad * 6.0f, 0.0f, seed);
    const float stain = value_noise(azimuth_rad * 25.0f, slope * 20.0f, seed + 1);
    const float skirting = slope < 0.004f ? 0.70f : 1.0f;
    return wall * (skirting * (1.0f + 0.04f * (panel > 0.0f ? 1.0f : -1.0f) + 0.02f * stain));
  }
  const float tops = 0.10f + 0.05f * value_noise(azimuth_rad * 9.0f, 0.5f, seed) +
                     0.02f * value_noise(azimuth_rad * 45.0f, 1.5f, seed + 1);
  if (slope < tops) {
    const float leaves = value_noise(azimuth_rad * 120.0f, slope * 120.0f, seed + 2);
    return Bgr{136.0f, 156.0f, 140.0f} * (1.0f + 0.12f * leaves);  // hazy
  }
  const float height = std::clamp(slope / 0.6f, 0.0f, 1.0f);
  const float cloud = value_noise(azimuth_rad * 4.0f, slope * 9.0f, seed + 3);
  return mix(Bgr{232.0f, 222.0f, 212.0f}, Bgr{228.0f, 186.0f, 148.0f}, height) *
         (1.0f + 0.04f * cloud);
}

float horizon_slope(const World& world, float camera_height_m) {
  return world.indoors ? -camera_height_m / kWallDistance_m : -0.004f;
}

Bgr surface_colour(const Appearance& appearance, const Bgr& base, float angle_rad, float radius_m,
                   float height_m, float footprint_m) {
  const std::uint32_t seed = appearance.texture_seed;
  const float around_m = angle_rad * radius_m;
  switch (appearance.texture) {
    case Appearance::Texture::kCardboard: {
      const float grain =
          value_noise(around_m * 90.0f, height_m * 90.0f, seed) * visible(footprint_m, 0.011f);
      // The spiral seam of a mailing tube.
      const float turns = angle_rad / 6.2831853f + height_m / 0.28f;
      const float seam = std::abs(turns - std::round(turns)) * 0.28f;
      const float dark = seam < 0.003f ? 0.12f * visible(footprint_m, 0.006f) : 0.0f;
      return base * (1.0f + 0.05f * grain - dark);
    }
    case Appearance::Texture::kBark: {
      const float streak =
          value_noise(around_m * 110.0f, height_m * 14.0f, seed) * visible(footprint_m, 0.009f);
      const float broad =
          value_noise(around_m * 35.0f, height_m * 5.0f, seed + 1) * visible(footprint_m, 0.03f);
      const float moss = std::max(0.0f, value_noise(around_m * 12.0f, height_m * 9.0f, seed + 2));
      const Bgr bark = base * (1.0f + 0.26f * streak + 0.14f * broad);
      return {bark.b, bark.g * (1.0f + 0.02f * moss), bark.r * (1.0f - 0.02f * moss)};
    }
    case Appearance::Texture::kLeaves: {
      const float leaf =
          value_noise(around_m * 60.0f, height_m * 60.0f, seed) * visible(footprint_m, 0.016f);
      return base * (1.0f + 0.35f * leaf);
    }
    case Appearance::Texture::kRoughBark: {
      const float streak =
          value_noise(around_m * 110.0f, height_m * 14.0f, seed) * visible(footprint_m, 0.009f);
      const float band =
          value_noise(around_m * 16.0f, height_m * 80.0f, seed + 1) * visible(footprint_m, 0.012f);
      const float patch = value_noise(around_m * 12.0f, height_m * 4.5f, seed + 2);
      const float grey = 0.114f * base.b + 0.587f * base.g + 0.299f * base.r;
      const Bgr lichen{grey * 1.10f, grey * 1.22f, grey * 1.18f};
      const Bgr moss{base.b * 0.62f, base.g * 0.98f, base.r * 0.78f};
      const Bgr skin = patch > 0.0f ? mix(base, lichen, std::min(1.0f, 1.2f * patch))
                                    : mix(base, moss, std::min(1.0f, -1.2f * patch));
      const float dark = band > 0.3f ? 0.9f * (band - 0.3f) : 0.0f;  // lenticels run around
      // Plates, scars and knots of a few centimetres, which are visible from some metres away.
      const float plate =
          value_noise(around_m * 26.0f, height_m * 24.0f, seed + 3) * visible(footprint_m, 0.04f);
      return skin * std::max(0.15f, 1.0f + 0.38f * streak + kPlates * plate - dark);
    }
    case Appearance::Texture::kWood: {
      const float grain =
          value_noise(around_m * 130.0f, height_m * 3.0f, seed) * visible(footprint_m, 0.008f);
      const float stain = value_noise(around_m * 9.0f, height_m * 2.5f, seed + 1);
      return base * (1.0f + 0.12f * grain + 0.10f * stain);
    }
  }
  return base;
}

}  // namespace orchard::simulation
