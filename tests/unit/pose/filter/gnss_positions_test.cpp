// SPDX-License-Identifier: BSD-3-Clause
#include "pose/filter/gnss_positions.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

namespace orchard::pose {
namespace {

/// A path of 60 m in map, its fixes turned by `yaw_rad` and moved by (100, -40), with noise.
std::vector<AntennaObservation> path(double yaw_rad, double sd_m, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<AntennaObservation> observations;
  for (int i = 0; i <= 120; ++i) {
    AntennaObservation observation;
    observation.p_map_m = {0.5 * i, i > 60 ? 4.0 : 0.0};
    observation.p_enu_m = Eigen::Rotation2Dd(yaw_rad) * observation.p_map_m +
                          Eigen::Vector2d(100.0, -40.0) +
                          sd_m * Eigen::Vector2d(normal(random), normal(random));
    observation.variance_m2 = sd_m * sd_m;
    observations.push_back(observation);
  }
  return observations;
}

TEST(GnssAlignment, FindsThePlaceOfAMapOnTheEarth) {
  for (const double yaw_rad : {0.0, 1.0, -3.0}) {
    const auto alignment = align_to_gnss(path(yaw_rad, 0.02, 3));
    ASSERT_TRUE(alignment);
    EXPECT_NEAR(alignment->x_y_yaw.x(), 100.0, 0.02);
    EXPECT_NEAR(alignment->x_y_yaw.y(), -40.0, 0.02);
    EXPECT_NEAR(alignment->x_y_yaw.z(), yaw_rad, 5e-4);
    EXPECT_NEAR(alignment->residual_rms_m, 0.02 * std::sqrt(2.0), 0.006);
  }
}

TEST(GnssAlignment, JumpsAreLeftOut) {
  auto observations = path(0.5, 0.02, 4);
  for (int i = 20; i < 50; ++i) observations[static_cast<std::size_t>(i)].p_enu_m.x() += 30.0;
  const auto alignment = align_to_gnss(observations);
  ASSERT_TRUE(alignment);
  EXPECT_NEAR(alignment->x_y_yaw.x(), 100.0, 0.03);
  EXPECT_EQ(alignment->num_left_out, 30);
}

TEST(GnssAlignment, AMapThatDoesNotFitItsFixesShowsIt) {
  auto observations = path(0.5, 0.02, 5);
  for (auto& observation : observations)
    observation.p_map_m.x() *= 1.05;  // drifted by 3 m over 60 m
  const auto alignment = align_to_gnss(observations);
  ASSERT_TRUE(alignment);
  EXPECT_GT(alignment->residual_rms_m, 0.3);
}

TEST(GnssAlignment, ARobotThatStandsHasNoHeading) {
  auto observations = path(0.5, 0.02, 6);
  for (auto& observation : observations) {
    observation.p_map_m *= 0.01;
    observation.p_enu_m =
        Eigen::Vector2d(100.0, -40.0) + 0.01 * (observation.p_enu_m - observation.p_enu_m);
  }
  EXPECT_FALSE(align_to_gnss(observations));
  EXPECT_FALSE(align_to_gnss({}));
  observations = path(0.5, 0.02, 6);
  observations.resize(9);
  EXPECT_FALSE(align_to_gnss(observations));
}

TEST(GnssPositions, HeightsAreAboveTheDatumWithTheirVariance) {
  GnssConfig config;
  config.datum = {48.0, 11.0, 500.0};
  GnssPositions positions(config);
  Gnss fix;
  fix.latitude_deg = 48.02;  // 2.2 km: the ellipsoid falls by 0.39 m from the level plane there
  fix.longitude_deg = 11.0;
  fix.altitude_m = 512.5;
  fix.fix_quality = 4;
  fix.covariance = {0.0004, 0.0, 0.0, 0.0004, 0.0, 0.0025};
  EXPECT_NEAR(positions.add(fix)->height_m, 12.5, 1e-9);
  EXPECT_DOUBLE_EQ(positions.add(fix)->height_variance_m2, 0.0025);
  fix.covariance[5] = 1e-8;  // a claim that no receiver keeps
  EXPECT_DOUBLE_EQ(positions.add(fix)->height_variance_m2, 0.0009);
  fix.covariance[5] = kUnknownAltitudeVariance_m2;
  EXPECT_EQ(positions.add(fix)->height_variance_m2, 0.0);
  fix.covariance = {};
  EXPECT_DOUBLE_EQ(positions.add(fix)->height_variance_m2, 0.0009);
  fix.altitude_m = 0.0;  // a source without altitudes
  EXPECT_EQ(positions.add(fix)->height_variance_m2, 0.0);
}

}  // namespace
}  // namespace orchard::pose
