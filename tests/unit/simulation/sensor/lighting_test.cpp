// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/sensor/lighting.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "simulation/sensor/shadow_map.hpp"

namespace orchard::simulation {
namespace {

// Planck's law written with h, c and k, per unit of frequency and turned into wavelength.
double planck(double wavelength_m, double temperature_k) {
  const double h = 6.62607015e-34, c = 299792458.0, k = 1.380649e-23;
  const double f = c / wavelength_m;
  const double per_hz = 2.0 * h * f * f * f / (c * c) / std::expm1(h * f / (k * temperature_k));
  return per_hz * c / (wavelength_m * wavelength_m);
}

TEST(Lighting, ColourTemperatureFollowsPlanck) {
  for (const double t_k : {3000.0, 4000.0, 5500.0, 8000.0}) {
    const auto gains = light_gains(t_k, 5500.0);
    const auto ratio = [&](double l_m) { return planck(l_m, t_k) / planck(l_m, 5500.0); };
    EXPECT_NEAR(gains[0], ratio(450e-9) / ratio(540e-9), 1e-5);
    EXPECT_DOUBLE_EQ(gains[1], 1.0);
    EXPECT_NEAR(gains[2], ratio(610e-9) / ratio(540e-9), 1e-5);
  }
  EXPECT_LT(light_gains(3000.0, 5500.0)[0], 0.6);  // tungsten light lacks blue
  EXPECT_GT(light_gains(8000.0, 5500.0)[0], 1.1);
}

TEST(Lighting, OneStopDoublesLinearLightUntilItClips) {
  LightConfig light;
  CameraResponseConfig response;
  const Lighting normal(light, response, 0.0);
  response.exposure_ev = 1.0;
  const Lighting brighter(light, response, 0.0);
  const auto linear = [](float stored) { return std::pow(stored / 255.0, 2.2); };
  for (const float value : {2.0f, 10.0f, 40.0f, 100.0f, 120.0f}) {
    const Bgr grey{value, value, value};
    const double once = linear(normal.store(grey, 0.0f).g);
    const double twice = linear(brighter.store(grey, 0.0f).g);
    EXPECT_NEAR(once, value / 255.0, 1e-3);
    EXPECT_NEAR(twice / once, 2.0, 0.01) << value;
  }
  EXPECT_FLOAT_EQ(brighter.store({140.0f, 140.0f, 140.0f}, 0.0f).g, 255.0f);
}

TEST(Lighting, VignettingTakesLightFromTheCorners) {
  CameraResponseConfig response;
  response.vignetting = 0.4;
  response.gamma = 1.0;
  const Lighting lighting({}, response, 0.0);
  EXPECT_NEAR(lighting.store({100, 100, 100}, 1.0f).g / lighting.store({100, 100, 100}, 0.0f).g,
              0.6, 1e-3);
}

TEST(Lighting, AutomaticExposureFollowsLateAndInPart) {
  LightConfig light;
  light.drift_ev_per_min = 6.0;
  CameraResponseConfig response;
  response.auto_exposure = 1.0;
  response.auto_exposure_lag_s = 2.0;
  // a first-order control stays its time constant behind a ramp: 0.1 EV/s times 2 s
  EXPECT_NEAR(std::log2(Lighting(light, response, 60.0).exposure_gain()), 0.2, 2e-3);
  response.auto_exposure = 0.0;
  EXPECT_NEAR(std::log2(Lighting(light, response, 60.0).exposure_gain()), 6.0, 1e-4);
  EXPECT_NEAR(light_temperature_k(light, 60.0), 5500.0, 1e-9);
}

TEST(Lighting, SunAndSkyFractionTheLight) {
  LightConfig light;
  light.sun_fraction = 0.8;
  const Lighting lighting(light, {}, 0.0);
  const Bgr albedo{100, 100, 100};
  EXPECT_NEAR(lighting.shade(albedo, 1.0f, 1.0f, 1.0f).g, 100.0, 1e-3);
  EXPECT_NEAR(lighting.shade(albedo, 1.0f, 0.0f, 1.0f).g, 20.0, 1e-3);  // in the shadow
  EXPECT_NEAR(lighting.shade(albedo, 0.5f, 1.0f, 1.0f).g, 60.0, 1e-3);
}

TEST(ShadowMap, ATrunkShadesWhereTheSunIsBehindIt) {
  World world;
  Cylinder trunk;
  trunk.radius_m = 0.15;
  trunk.height_m = 2.0;
  world.cylinders.push_back(trunk);
  // the sun in the direction of map x at 45 degrees: the shadow lies on -x, two metres long
  const ShadowMap map(world, 0.0, 0.7853981633974483);
  EXPECT_FLOAT_EQ(map.open(-1.0f, 0.0f, 0.0f, -2), 0.0f);
  EXPECT_FLOAT_EQ(map.open(-1.9f, 0.0f, 0.0f, -2), 0.0f);
  EXPECT_FLOAT_EQ(map.open(-2.3f, 0.0f, 0.0f, -2), 1.0f);
  EXPECT_FLOAT_EQ(map.open(1.0f, 0.0f, 0.0f, -2), 1.0f);
  EXPECT_FLOAT_EQ(map.open(-1.0f, 0.3f, 0.0f, -2), 1.0f);
  EXPECT_FLOAT_EQ(map.open(-1.0f, 0.0f, 0.5f, -2), 0.0f);  // a man's knee in it
  EXPECT_FLOAT_EQ(map.open(-1.0f, 0.0f, 1.5f, -2), 1.0f);  // his head is above it
  EXPECT_FLOAT_EQ(map.open(-1.0f, 0.0f, 0.0f, 0), 1.0f);   // none on itself
}

}  // namespace
}  // namespace orchard::simulation
