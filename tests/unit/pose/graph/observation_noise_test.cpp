// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/observation_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "simulation/random.hpp"

namespace orchard::pose {
namespace {

constexpr int kHalf = 5;  // observations of half a visit
constexpr double kSd_m = 0.05;
constexpr double kSeen_m = 8.0;

/// Errors of a landmark's observations: white ones as claimed, and one for each half of a visit,
/// one for each visit, one for each landmark.
struct Errors {
  double half_m = 0.0;
  double visit_m = 0.0;
  double wrong_fraction = 0.0;  // of the visits: their second half is of a neighbour 0.7 m away
};

double learnt(const Errors& errors, int num_landmarks, std::uint64_t seed) {
  simulation::Random random(seed);
  const auto drawn = [&](double sd_m) {
    const double x_m = random.normal(0.0, sd_m), y_m = random.normal(0.0, sd_m);
    return Eigen::Vector2d(x_m, y_m);
  };
  ObservationScatter scatter;
  for (int l = 0; l < num_landmarks; ++l) {
    const Eigen::Vector2d p_map(1.4 * l, 3.0);
    std::vector<PlacedObservation> seen;
    for (int visit = 0; visit < 2; ++visit) {
      const Eigen::Vector2d of_visit_m = drawn(errors.visit_m);
      const bool is_wrong = random.uniform() < errors.wrong_fraction;
      for (int half = 0; half < 2; ++half) {
        Eigen::Vector2d off_m = of_visit_m + drawn(errors.half_m);
        if (is_wrong && half == 1) off_m.x() += 0.7;
        for (int i = 0; i < kHalf; ++i) {
          PlacedObservation& one = seen.emplace_back();
          one.travel_m = 100.0 * visit + 0.5 * (kHalf * half + i);
          one.position.information = Eigen::Matrix2d::Identity() / (kSd_m * kSd_m);
          one.position.information_m = one.position.information * (p_map + off_m + drawn(kSd_m));
        }
      }
    }
    scatter.add(seen, kSeen_m);
  }
  return scatter.noise();
}

TEST(ObservationScatter, WhiteErrorsAreWhatTheyClaim) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) EXPECT_EQ(learnt({}, 500, seed), 1.0) << seed;
}

TEST(ObservationScatter, WhatLastsOverHalfAVisitIsLearnt) {
  // The mean of a half has variance sd^2 / 5 + half^2 where sd^2 / 5 is claimed.
  for (const double half_m : {0.05, 0.1}) {
    const double truth = 1.0 + kHalf * half_m * half_m / (kSd_m * kSd_m);
    double sum = 0.0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const double noise = learnt({half_m}, 2000, seed);
      EXPECT_LT(noise, truth) << "surely so much";
      sum += noise;
    }
    EXPECT_NEAR(sum / 20, truth, 0.1 * truth);
  }
}

TEST(ObservationScatter, AFewWrongPairsAreNoNoise) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    EXPECT_LT(learnt({0.0, 0.0, 0.03}, 1000, seed), 1.05) << seed;
  }
}

TEST(ObservationScatter, OneVisitIsNotComparedWithTheNext) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    EXPECT_EQ(learnt({0.0, 0.5}, 500, seed), 1.0) << seed;
  }
}

TEST(ObservationScatter, FewLandmarksTellNothing) {
  EXPECT_EQ(ObservationScatter().noise(), 1.0);
  EXPECT_EQ(learnt({0.1}, 5, 1), 1.0);
  ObservationScatter scatter;
  scatter.add({}, kSeen_m);
  scatter.add({{0.0, {}}, {0.5, {}}}, kSeen_m);  // without information
  EXPECT_EQ(scatter.noise(), 1.0);
}

}  // namespace
}  // namespace orchard::pose
