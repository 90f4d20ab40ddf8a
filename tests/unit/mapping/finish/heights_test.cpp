// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/finish/heights.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "geometry/angles.hpp"
#include "unit/nees_band.hpp"

namespace orchard::mapping {
namespace {

/// Two aisles along x, beside a row of trees at y = 0, on a plane of 10 % and -5 %.
double plane_m(double x_m, double y_m) { return 3.0 + 0.10 * x_m - 0.05 * y_m; }

pose::GroundProfile aisles(const std::vector<double>& ys_m, bool has_tilt,
                           double variance_m2 = 5e-4) {
  pose::GroundProfile ground;
  for (const double y_m : ys_m) {
    for (int x = 0; x <= 40; ++x) {
      pose::GroundPoint& p = ground.emplace_back();
      p.x_m = x, p.y_m = y_m, p.z_m = plane_m(x, y_m), p.variance_m2 = variance_m2;
      if (has_tilt) p.gradient = Eigen::Vector2d(0.10, -0.05), p.slope_variance = 1e-4;
    }
  }
  return ground;
}

std::vector<Landmark> tree_at(double x_m, double y_m) {
  Landmark l;
  l.id = 1, l.x_m = x_m, l.y_m = y_m;
  return {l};
}

TEST(Heights, TheGroundAtATrunkIsThatOfThePlaneNearby) {
  for (const auto& [ys_m, has_tilt] : {std::pair(std::vector<double>{-2.0}, true),
                                       std::pair(std::vector<double>{-2.0, 2.0}, false)}) {
    auto trees = tree_at(13.3, 0.1);
    set_heights(aisles(ys_m, has_tilt), trees);
    EXPECT_NEAR(trees[0].z_m, plane_m(13.3, 0.1), 0.01);
    EXPECT_GT(trees[0].z_sd_m, 0.02);
    EXPECT_LT(trees[0].z_sd_m, 0.10);
  }
}

TEST(Heights, FromOneAisleWithoutATiltTheSlopeAcrossIsUnknownAndSaid) {
  auto trees = tree_at(13.3, 0.1);
  set_heights(aisles({-2.0}, false), trees);
  EXPECT_NEAR(trees[0].z_m, plane_m(13.3, 0.1), 2.0 * trees[0].z_sd_m);
  EXPECT_GT(trees[0].z_sd_m, 0.2);  // 2.1 m beside, on a slope of 12 % or less
}

/// Ground whose heights differ between places a distance d apart by a variance of 0.004 m d, about
/// a plane: by many waves, each of its own direction.
class RoughGround {
 public:
  explicit RoughGround(unsigned seed) : random_(seed) {
    std::uniform_real_distribution<double> uniform(0.0, 2.0 * geometry::kPi);
    constexpr int kWaves = 400;
    for (int i = 0; i < kWaves; ++i) {
      // The density c / n^2 of a profile, in equal steps of the logarithm of n, 0.01 to 10 per
      // metre.
      const double low = 0.01 * std::pow(1e3, static_cast<double>(i) / kWaves);
      const double high = 0.01 * std::pow(1e3, static_cast<double>(i + 1) / kWaves);
      const double density_m = 0.5 * geometry::kPi * kWalk_m / square(2.0 * geometry::kPi) * 2.0;
      const double towards = uniform(random_), k = 2.0 * geometry::kPi * std::sqrt(low * high);
      waves_.push_back({k * std::cos(towards), k * std::sin(towards), uniform(random_),
                        std::sqrt(2.0 * density_m * (1.0 / low - 1.0 / high))});
    }
  }
  double height_m(double x_m, double y_m) const {
    double z_m = plane_m(x_m, y_m);
    for (const auto& w : waves_) z_m += w[3] * std::sin(w[0] * x_m + w[1] * y_m + w[2]);
    return z_m;
  }
  static constexpr double kWalk_m = 0.004;

 private:
  static double square(double v) { return v * v; }
  std::mt19937 random_;
  std::vector<std::array<double, 4>> waves_;
};

/// A robot of four wheels stands on it, in an aisle: the mean height and the slopes.
pose::GroundPoint stand(const RoughGround& ground, double x_m, double y_m) {
  pose::GroundPoint p;
  p.x_m = x_m, p.y_m = y_m, p.variance_m2 = 1e-4, p.slope_variance = 1e-5;
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  constexpr int kSteps = 5;  // in the metre
  for (int s = 0; s < kSteps; ++s) {
    for (const double ahead : {-0.5, 0.5}) {
      for (const double left : {-0.5, 0.5}) {
        const double off_m = (s + 0.5) / kSteps - 0.5;
        const double z_m = ground.height_m(x_m + off_m + ahead, y_m + left);
        p.z_m += z_m / (4 * kSteps);
        slope += z_m / kSteps * Eigen::Vector2d(ahead, left);
      }
    }
  }
  p.gradient = slope;
  return p;
}

TEST(Heights, AreAsCertainAsTheySayOnRoughGround) {
  for (const auto& ys_m : {std::vector<double>{-2.0}, std::vector<double>{-2.0, 2.0}}) {
    double over_claim = 0.0;
    constexpr int kGrounds = 60;
    for (unsigned seed = 1; seed <= kGrounds; ++seed) {
      const RoughGround ground(seed);
      pose::GroundProfile profile;
      for (const double y_m : ys_m) {
        for (int x = 0; x <= 12; ++x) profile.push_back(stand(ground, x, y_m));
      }
      auto trees = tree_at(6.3, 0.1);
      set_heights(profile, trees);
      over_claim += std::pow((trees[0].z_m - ground.height_m(6.3, 0.1)) / trees[0].z_sd_m, 2);
    }
    const test::NeesBand band = test::nees_band(1, kGrounds);
    EXPECT_GT(over_claim / kGrounds, band.least) << ys_m.size();
    EXPECT_LT(over_claim / kGrounds, band.most) << ys_m.size();
  }
}

// By fixes alone, of a plane: what they err by themselves is no roughness of the ground.
TEST(Heights, TheErrorsOfSingleFixesAreNoRoughness) {
  std::mt19937 random(3);
  std::normal_distribution<double> error_m(0.0, 0.04);
  double over_claim = 0.0;
  constexpr int kDrives = 60;
  for (int drive = 0; drive < kDrives; ++drive) {
    pose::GroundProfile ground = aisles({-2.0, 2.0}, false, 1e-6);
    for (pose::GroundPoint& p : ground) {
      p.z_m += error_m(random);
      p.own_variance_m2 = 0.04 * 0.04;
    }
    auto trees = tree_at(13.3, 0.1);
    set_heights(ground, trees);
    EXPECT_LT(trees[0].z_sd_m, 0.04);
    over_claim += std::pow((trees[0].z_m - plane_m(13.3, 0.1)) / trees[0].z_sd_m, 2);
  }
  EXPECT_LT(over_claim / kDrives, test::nees_band(1, kDrives).most);
}

// A scanner 0.7 m above a slope of 25 % that is taken as level sees trees 0.17 m uphill.
TEST(Heights, WithoutATiltTheyHoldThatTreesSeemToStandUphill) {
  pose::GroundProfile ground;
  for (const double y_m : {-2.0, 2.0}) {
    for (int x = 0; x <= 40; ++x) {
      pose::GroundPoint& p = ground.emplace_back();
      p.x_m = x, p.y_m = y_m, p.z_m = 0.25 * x, p.own_variance_m2 = 1e-6;
    }
  }
  auto seen = tree_at(13.3 + 0.7 * 0.25, 0.1);
  set_heights(ground, seen);
  const double error_m = seen[0].z_m - 0.25 * 13.3;
  EXPECT_NEAR(error_m, 0.044, 0.005);
  EXPECT_LT(error_m, 1.5 * seen[0].z_sd_m);
}

TEST(Heights, FarFromThePathAndForUncertainHeightsTheyAreUnknown) {
  auto trees = tree_at(13.3, 12.0);
  set_heights(aisles({-2.0, 2.0}, true), trees);
  EXPECT_EQ(trees[0].z_sd_m, 0.0);
  auto near = tree_at(13.3, 0.0);
  set_heights(aisles({-2.0, 2.0}, true, 4.5), near);  // of single fixes, 3 m upwards
  EXPECT_EQ(near[0].z_sd_m, 0.0);
  set_heights({}, near);
  EXPECT_EQ(near[0].z_sd_m, 0.0);
}

}  // namespace
}  // namespace orchard::mapping
