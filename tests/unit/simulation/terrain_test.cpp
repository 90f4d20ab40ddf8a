// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scene/terrain.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <vector>

#include "geometry/angles.hpp"
#include "simulation/random.hpp"
#include "simulation/scene/wheeled_body.hpp"

namespace orchard::simulation {
namespace {

constexpr double kFieldRoughness_m3 = 4096e-6;  // ISO 8608, class E

TerrainConfig rolling() {
  TerrainConfig config;
  config.slope_along_percent = 12.0;
  config.slope_across_percent = -7.0;
  config.terrace_height_m = 0.4;
  config.roughness_m3 = kFieldRoughness_m3;
  return config;
}

TEST(Terrain, WithoutKeysIsLevel) {
  EXPECT_TRUE(TerrainConfig{}.is_flat());
  const Terrain terrain(1, {});
  EXPECT_EQ(terrain.height_m(12.3, -4.5), 0.0);
  EXPECT_EQ(terrain.gradient(12.3, -4.5).norm(), 0.0);
}

TEST(Terrain, GradientIsTheDerivativeOfTheHeight) {
  const Terrain terrain(3, rolling());
  Random random(1);
  constexpr double kStep_m = 1e-5;
  for (int i = 0; i < 500; ++i) {
    const double x_m = random.uniform(-20.0, 20.0), y_m = random.uniform(-20.0, 20.0);
    const Eigen::Vector2d slope = terrain.gradient(x_m, y_m);
    const double along_x =
        (terrain.height_m(x_m + kStep_m, y_m) - terrain.height_m(x_m - kStep_m, y_m)) /
        (2.0 * kStep_m);
    const double along_y =
        (terrain.height_m(x_m, y_m + kStep_m) - terrain.height_m(x_m, y_m - kStep_m)) /
        (2.0 * kStep_m);
    EXPECT_NEAR(slope.x(), along_x, 1e-4) << x_m << " " << y_m;  // banks begin without curvature
    EXPECT_NEAR(slope.y(), along_y, 1e-7) << x_m << " " << y_m;
  }
}

TEST(Terrain, TerracesRiseByTheirHeightBetweenBanks) {
  TerrainConfig config;
  config.terrace_height_m = 0.5;
  config.terrace_width_m = 4.0;
  const Terrain terrain(1, config);
  EXPECT_NEAR(terrain.height_m(0.0, 3.0), 0.0, 1e-12);
  EXPECT_NEAR(terrain.height_m(1.7, 3.0), 0.0, 1e-12);  // banks are as long as high
  EXPECT_NEAR(terrain.height_m(2.0, 3.0), 0.25, 1e-12);
  EXPECT_NEAR(terrain.height_m(2.3, 3.0), 0.5, 1e-12);
  EXPECT_NEAR(terrain.height_m(8.0, 3.0), 1.0, 1e-12);
  EXPECT_NEAR(terrain.height_m(-4.0, 3.0), -0.5, 1e-12);
}

/// Mean over many bumpy places and directions of the spectral density of profiles [m3], one-sided,
/// at a frequency, by a windowed transform.
double profile_density_m3(double frequency_perm) {
  TerrainConfig config;
  config.roughness_m3 = kFieldRoughness_m3;
  constexpr int kPoints = 4000, kGrounds = 800;
  constexpr double kStep_m = 0.05;
  double sum_m3 = 0.0, window_2 = 0.0;
  for (int seed = 0; seed < kGrounds; ++seed) {
    const Terrain terrain(static_cast<std::uint64_t>(seed), config);
    std::complex<double> sum_m = 0.0;
    for (int i = 0; i < kPoints; i += 5) {
      const double s_m = kStep_m * i;
      const double window = 1.0 - std::cos(2.0 * geometry::kPi * i / kPoints);
      if (seed == 0) window_2 += window * window;
      sum_m += window * terrain.height_m(s_m, 0.0) *
               std::polar(1.0, -2.0 * geometry::kPi * frequency_perm * s_m);
    }
    sum_m3 += 2.0 * std::norm(sum_m) * 5.0 * kStep_m;
  }
  return sum_m3 / (kGrounds * window_2);
}

// Gd(n) = Gd(n0) (n / n0)^-2: ISO 8608:2016, equation 2
TEST(Terrain, ProfilesHaveTheSpectrumOfIso8608) {
  for (const double n_perm : {0.2, 0.5, 1.0}) {
    const double wanted_m3 = kFieldRoughness_m3 * std::pow(n_perm / 0.1, -2.0);
    EXPECT_NEAR(profile_density_m3(n_perm) / wanted_m3, 1.0, 0.15) << n_perm;
  }
}

// integral of pi/2 Gd(n0) (n / n0)^-2 from 0.05 to 2.83 cycles/m
TEST(Terrain, BumpsHaveTheVarianceOfTheIntegral) {
  TerrainConfig config;
  config.roughness_m3 = kFieldRoughness_m3;
  double sum_m2 = 0.0, sum = 0.0;
  constexpr int kGrounds = 8000;
  Random random(5);
  for (int seed = 0; seed < kGrounds; ++seed) {
    const Terrain terrain(static_cast<std::uint64_t>(seed), config);
    const double x_m = random.uniform(-50.0, 50.0), y_m = random.uniform(-50.0, 50.0);
    sum_m2 += std::pow(terrain.height_m(x_m, y_m), 2);
    sum += terrain.gradient(x_m, y_m).squaredNorm();
  }
  const double c_m = 0.5 * geometry::kPi * kFieldRoughness_m3 * 0.01;
  EXPECT_NEAR(sum_m2 / kGrounds / (c_m * (1.0 / 0.05 - 1.0 / 2.83)), 1.0, 0.05);
  const double steep = std::pow(2.0 * geometry::kPi, 2) * c_m * (2.83 - 0.05);
  EXPECT_NEAR(sum / kGrounds / steep, 1.0, 0.05);
}

TEST(WheeledBody, StandsOnASlopeAsThePlaneLies) {
  TerrainConfig config;
  config.slope_along_percent = 20.0;
  config.slope_across_percent = 10.0;
  const WheeledBody body(Terrain(1, config), config);
  const Eigen::Vector3d normal = Eigen::Vector3d(-0.1, -0.2, 1.0).normalized();
  for (double yaw_rad = -3.0; yaw_rad < 3.1; yaw_rad += 0.5) {
    const Pose3 pose = body.stand_at({3.0, -2.0, yaw_rad});
    EXPECT_NEAR(pose.z_m, 0.1 * 3.0 - 0.2 * 2.0, 1e-12);
    const Eigen::Isometry3d T_map_base = pose.transform();
    EXPECT_NEAR((T_map_base.linear().col(2) - normal).norm(), 0.0, 1e-12);
    EXPECT_NEAR(std::atan2(T_map_base.linear()(1, 0), T_map_base.linear()(0, 0)), yaw_rad, 1e-12);
  }
  // uphill, along map y: nose up by the angle of the slope
  EXPECT_NEAR(body.stand_at({0.0, 0.0, 0.5 * geometry::kPi}).pitch_rad, -std::atan(0.2), 1e-12);
  EXPECT_GT(body.stand_at({0.0, 0.0, -0.5 * geometry::kPi}).pitch_rad, 0.0);
  EXPECT_LT(body.stand_at({0.0, 0.0, 0.5 * geometry::kPi}).roll_rad, 0.0);  // +x is to the right
}

// From the difference of two means of two wheels: white slopes of density (2 pi n0)^2 Gd(n0) per
// metre, averaged over the wheelbase, have the variance 2 pi^2 n0^2 Gd(n0) / wheelbase, less what
// wheels beside each other do not share.
TEST(WheeledBody, PitchesOnBumpsByTheirSpectrum) {
  TerrainConfig config;
  config.roughness_m3 = kFieldRoughness_m3;
  config.track_m = 0.1;  // nearly a bicycle
  double sum = 0.0;
  constexpr int kGrounds = 3000;
  for (int seed = 0; seed < kGrounds; ++seed) {
    const WheeledBody body(Terrain(static_cast<std::uint64_t>(seed), config), config);
    sum += std::pow(body.stand_at({1.0, 2.0, 0.3}).pitch_rad, 2);
  }
  const double bound =
      2.0 * std::pow(geometry::kPi * 0.1, 2) * kFieldRoughness_m3 / config.wheelbase_m;
  EXPECT_LT(sum / kGrounds, bound);
  EXPECT_GT(sum / kGrounds, 0.8 * bound);
}

}  // namespace
}  // namespace orchard::simulation
