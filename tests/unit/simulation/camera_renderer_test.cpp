// SPDX-License-Identifier: BSD-3-Clause

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <optional>

#include "geometry/angles.hpp"
#include "geometry/camera_model.hpp"
#include "simulation/sensor/camera_renderer.hpp"
#include "simulation/sensor/lighting.hpp"
#include "simulation/texture.hpp"
#include "unit/simulation/rig.hpp"

namespace orchard::simulation {
namespace {

/// A white cylinder without texture's help, and the same world without it.
World white_cylinder(double x_m, double y_m, double radius_m) {
  World world;
  world.ambient = 1.0;
  Cylinder cylinder;
  cylinder.x_m = x_m;
  cylinder.y_m = y_m;
  cylinder.radius_m = radius_m;
  cylinder.height_m = 0.5;
  cylinder.appearance.saturation = 0.0;
  cylinder.appearance.value = 1.0;
  world.cylinders.push_back(cylinder);
  return world;
}

/// Where the difference between two pictures crosses half of its value inside, along a row
/// between two columns [px].
std::optional<double> edge_column(const Picture& with, const Picture& without, int v, int u_outside,
                                  int u_inside) {
  const auto fraction = [&](int u) {
    const std::size_t i = 3 * (static_cast<std::size_t>(v) * with.width_px + u);
    const double inside = 255.0 - without.bgr[i];
    return (with.bgr[i] - without.bgr[i]) / inside;
  };
  const int step = u_inside > u_outside ? 1 : -1;
  for (int u = u_outside; u != u_inside; u += step) {
    const double a = fraction(u), b = fraction(u + step);
    if (a < 0.5 && b >= 0.5) return u + step * (0.5 - a) / (b - a);
  }
  return std::nullopt;
}

// The laser's way to an edge: the tangent ray's touching point through the extrinsics and
// Bouguet's model. The renderer's: one ray per pixel. They meet within half a pixel.
TEST(CameraRenderer, RenderedEdgesAreWhereTheLaserProjectsThem) {
  const RigConfig rig = test_rig();
  const CameraRenderer renderer(rig);
  const geometry::CameraModel camera(rig.camera.intrinsics);
  const geometry::LaserToCamera to_camera(rig.camera.extrinsics);
  const Pose2 T_map_base{0.4, 1.2, geometry::kPi / 2.0};
  const Pose2 T_map_laser = compose(T_map_base, {rig.laser.mount_x_m, 0.0, 0.0});
  int num_edges = 0;
  for (const double range_m : {0.8, 1.5, 2.5, 4.0}) {
    for (const double bearing_rad : {-0.45, -0.2, 0.0, 0.25, 0.5}) {
      const double radius_m = 0.085;
      const Pose2 centre = compose(
          T_map_laser, {range_m * std::cos(bearing_rad), range_m * std::sin(bearing_rad), 0});
      const World world = white_cylinder(centre.x_m, centre.y_m, radius_m);
      World empty = world;
      empty.cylinders.clear();
      const Picture with = renderer.draw(world, T_map_base);
      const Picture without = renderer.draw(empty, T_map_base);
      // tangent rays as seen from the camera, which stands nearly under the laser
      const Eigen::Vector3d camera_in_laser =
          -(to_camera.rotation().transpose() * to_camera.translation_m());
      const double dx = range_m * std::cos(bearing_rad) - camera_in_laser.x();
      const double dy = range_m * std::sin(bearing_rad) - camera_in_laser.y();
      const double distance_m = std::hypot(dx, dy), half_rad = std::asin(radius_m / distance_m);
      const double tangent_m = distance_m * std::cos(half_rad);
      for (const double side : {-1.0, 1.0}) {
        const double angle_rad = std::atan2(dy, dx) + side * half_rad;
        const auto pixel =
            camera.project(to_camera({camera_in_laser.x() + tangent_m * std::cos(angle_rad),
                                      camera_in_laser.y() + tangent_m * std::sin(angle_rad), 0.0}));
        ASSERT_TRUE(pixel);
        if (pixel->x() < 12 || pixel->x() > 307) continue;
        const int inward = side > 0 ? 1 : -1;  // left in the world is left in the picture
        const int u = static_cast<int>(std::lround(pixel->x()));
        const auto found = edge_column(with, without, static_cast<int>(std::lround(pixel->y())),
                                       u - 4 * inward, u + 4 * inward);
        ASSERT_TRUE(found) << range_m << " " << bearing_rad;
        EXPECT_NEAR(*found, pixel->x(), 0.6) << range_m << " " << bearing_rad;
        ++num_edges;
      }
    }
  }
  EXPECT_GT(num_edges, 25);
}

TEST(CameraRenderer, NearerCylindersCoverFartherOnes) {
  const CameraRenderer renderer(test_rig());
  World world = white_cylinder(3.0, 0.0, 0.2);
  World near = white_cylinder(1.5, 0.0, 0.05);
  near.cylinders[0].appearance.value = 0.0;
  world.cylinders.push_back(near.cylinders[0]);
  const Picture picture = renderer.draw(world, {});
  int num_black = 0;
  for (int u = 0; u < 320; ++u) {
    if (picture.bgr[3 * (118 * 320 + u)] < 10.0f) ++num_black;
  }
  EXPECT_NEAR(num_black, 221.5 * 0.1 / 1.4, 2.0);
}

TEST(CameraRenderer, PicturesAreSmallJpegsOfTheRightSize) {
  const RigConfig rig = test_rig();
  const CameraRenderer renderer(rig);
  const Scene scene = make_tube_scene(4, rig);
  for (const std::size_t stop : {std::size_t{0}, scene.stops.size() / 2, scene.stops.size() - 1}) {
    Random random(4, Stream::kImage, stop);
    const vision::Image image = renderer.take(scene.world, scene.stops[stop], random);
    EXPECT_LT(image.data.size(), 20000u);
    EXPECT_GT(image.data.size(), 3000u);
    const cv::Mat decoded = cv::imdecode(image.data, cv::IMREAD_COLOR);
    EXPECT_EQ(decoded.cols, 320);
    EXPECT_EQ(decoded.rows, 240);
  }
}

// Photographs of trunks (cherry_trunks 000-019), trunks 10 px wide: neighbours along the trunk, an
// eighth of its width apart, differ by 0.14 (nine of ten windows: 0.10 or more) in the log of
// stored light. Sawn posts have nothing of the kind.
TEST(Texture, BarkIsRestlessAlongTheTrunkFromSomeMetresAway) {
  const Bgr base = from_hsv(40.0, 0.25, 0.5);
  const auto along = [&](Appearance::Texture texture, float footprint_m) {
    double sum = 0.0;
    int n = 0;
    for (std::uint32_t seed = 1; seed <= 40; ++seed) {
      Appearance appearance;
      appearance.texture = texture;
      appearance.texture_seed = seed;
      for (float height_m = 0.0f; height_m < 0.5f; height_m += 0.015f, ++n) {
        const auto green = [&](float h_m) {
          return surface_colour(appearance, base, 0.3f, 0.06f, h_m, footprint_m).g;
        };
        sum += std::abs(std::log(green(height_m + 0.015f) / green(height_m)));
      }
    }
    return sum / n;
  };
  const float footprint_m = 0.0125f;  // 10 px across a trunk of 125 mm
  const double bark = along(Appearance::Texture::kRoughBark, footprint_m);
  EXPECT_GT(bark, 0.08);
  EXPECT_LT(bark, 0.20);
  EXPECT_LT(along(Appearance::Texture::kWood, footprint_m), 0.25 * bark);
}

TEST(Texture, HsvIsThatOfThePaper) {
  const Bgr red = from_hsv(0.0, 1.0, 1.0), green = from_hsv(120.0, 1.0, 0.5);
  EXPECT_FLOAT_EQ(red.r, 255.0f);
  EXPECT_FLOAT_EQ(red.g, 0.0f);
  EXPECT_FLOAT_EQ(green.g, 127.5f);
  EXPECT_FLOAT_EQ(green.r, 0.0f);
  // hue 30 lies midway from red to yellow
  const Bgr orange = from_hsv(30.0, 0.5, 0.8);
  EXPECT_NEAR(orange.r, 204.0, 1e-3);
  EXPECT_NEAR(orange.g, 153.0, 1e-3);
  EXPECT_NEAR(orange.b, 102.0, 1e-3);
}

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
