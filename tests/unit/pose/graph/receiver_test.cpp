// SPDX-License-Identifier: BSD-3-Clause
// Truth: a straight drive at 2 m/s; fixes with an error of known kind: white, or a Gauss-Markov
// process of 60 s in its exact discrete form.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "pose/graph/georeference.hpp"
#include "pose/graph/solver.hpp"
#include "simulation/random.hpp"
#include "unit/nees_band.hpp"

namespace orchard::pose {
namespace {

constexpr double kSpeed_mps = 2.0;
constexpr double kClaimed_m = 2.5;

struct Fixes {
  double white_m = 0.0;
  double lasting_m = 0.0;
  double reflected_from_s = -1.0;  ///< for 8 s, 12 m to the north
  double claimed_m = kClaimed_m;
};

/// A keyframe and five fixes a second; the true path is the map's x axis.
SlamGraph drive(const Fixes& fixes, std::uint64_t seed, double duration_s = 120.0) {
  simulation::Random random(seed);
  SlamGraph graph;
  graph.calibrations.emplace_back(OdometryCalibration::Zero());
  graph.georeferenced = true;
  Eigen::Vector2d lasting_m(random.normal(), random.normal());
  lasting_m *= fixes.lasting_m;
  const double kept = std::exp(-0.2 / 60.0);
  const double fresh_m = fixes.lasting_m * std::sqrt(1.0 - kept * kept);
  for (int k = 0; k < static_cast<int>(duration_s); ++k) {
    Keyframe keyframe;
    keyframe.utime = 1'000'000LL * k;
    keyframe.T_map_base = {kSpeed_mps * k, 0.0, 0.0};
    keyframe.travel_m = kSpeed_mps * k;
    keyframe.motion.delta = {kSpeed_mps, 0.0, 0.0};
    keyframe.motion.covariance = Eigen::Vector3d(1e-4, 1e-4, 1e-6).asDiagonal();
    graph.keyframes.push_back(keyframe);
    for (int i = 0; i < 5; ++i) {
      const double time_s = k + 0.2 * i;
      AbsolutePosition position;
      position.utime = static_cast<std::int64_t>(1e6 * time_s);
      position.T_keyframe_then = {0.2 * i * kSpeed_mps, 0.0, 0.0};
      position.covariance = fixes.claimed_m * fixes.claimed_m * Eigen::Matrix2d::Identity();
      position.is_gnss = true;
      const double east_m = random.normal(), north_m = random.normal();
      position.p_map = Eigen::Vector2d(kSpeed_mps * time_s, 0.0) + lasting_m +
                       fixes.white_m * Eigen::Vector2d(east_m, north_m);
      const double since_s = time_s - fixes.reflected_from_s;
      if (fixes.reflected_from_s >= 0.0 && since_s >= 0.0 && since_s < 8.0) {
        position.p_map.y() += 12.0;
      }
      const double new_east_m = random.normal(), new_north_m = random.normal();
      lasting_m = kept * lasting_m + fresh_m * Eigen::Vector2d(new_east_m, new_north_m);
      add_position(position, graph);
    }
  }
  return graph;
}

TEST(Receiver, WhatItsStepsShowIsNoiseAndTheRestLasts) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const ReceiverModel white = estimate_receiver_model(drive({kClaimed_m, 0.0}, seed));
    EXPECT_EQ(white.correlated, 0.0);
    EXPECT_EQ(white.noise, 1.0);
    const ReceiverModel correlated = estimate_receiver_model(drive({0.3, kClaimed_m}, seed));
    EXPECT_GT(correlated.correlated, 0.9);
    EXPECT_NEAR(correlated.noise + correlated.correlated, 1.0, 1e-12);
    // three times what is claimed
    const ReceiverModel claims = estimate_receiver_model(drive({3.0 * kClaimed_m, 0.0}, seed));
    EXPECT_NEAR(claims.noise, 9.0, 2.5);
  }
}

TEST(Receiver, ABurstIsNotSoManyFixesOfItsOwn) {
  double nees = 0.0, nees_white = 0.0;
  constexpr int kRuns = 30;
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    for (const bool is_white : {false, true}) {
      SlamGraph graph =
          is_white ? drive({kClaimed_m, 0.0}, seed, 20.0) : drive({0.3, kClaimed_m}, seed, 20.0);
      ASSERT_TRUE(solve_graph(graph, false, SlamConfig{}).solved);
      const Keyframe& last = graph.keyframes.back();
      const Eigen::Vector2d error(last.T_map_base.x() - last.travel_m, last.T_map_base.y());
      const Eigen::Matrix2d P = last.covariance.topLeftCorner<2, 2>();
      (is_white ? nees_white : nees) += error.dot(P.inverse() * error) / kRuns;
    }
  }
  const auto band = test::nees_band(2, kRuns);
  for (const double mean : {nees, nees_white}) {
    EXPECT_GT(mean, band.least);
    EXPECT_LT(mean, band.most);
  }
}

TEST(Receiver, TheDriveShowsTheSlowErrorWhateverIsClaimed) {
  constexpr int kRuns = 5;
  constexpr double kSlow_m = 1.7;
  for (const double claimed_m : {0.3, 1.7, 5.0}) {
    double ratio = 0.0;
    for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
      SlamGraph graph = drive({0.3, kSlow_m, -1.0, claimed_m}, seed, 900.0);
      for (int i = 0; i < 6; ++i) ASSERT_TRUE(solve_graph(graph, false, SlamConfig{}).solved);
      EXPECT_EQ(receiver_text(graph).empty(), claimed_m > 1.0);
      ratio += *graph.receiver.learnt_correlated * claimed_m * claimed_m / (kSlow_m * kSlow_m);
    }
    // Fifteen minutes hold some 60 independent errors of two axes; the path is not quite stiff.
    EXPECT_GT(ratio / kRuns, 0.6) << claimed_m;
    EXPECT_LT(ratio / kRuns, 1.5) << claimed_m;
  }
  SlamGraph white = drive({0.3, 0.0, -1.0, 0.3}, 1, 300.0);
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(solve_graph(white, false, SlamConfig{}).solved);
  EXPECT_LT(std::sqrt(*white.receiver.learnt_correlated) * 0.3, 0.06);
}

TEST(Receiver, ReflectionsAreLeftOutAndSaid) {
  SlamGraph graph = drive({0.3, 1.0, 60.0}, 5);
  ASSERT_TRUE(solve_graph(graph, false, SlamConfig{}).solved);
  for (const Keyframe& k : graph.keyframes) {
    EXPECT_LT(std::abs(k.T_map_base.y()), 4.0);
  }
  EXPECT_EQ(rejected_fixes(drive({0.3, kClaimed_m}, 5)).num_fixes, 600);
}

TEST(Receiver, APathIsLaidOnPositionsOfWhichSomeAreReflected) {
  SlamGraph graph = drive({0.3, 1.0, 4.0}, 3, 60.0);
  graph.georeferenced = false;
  const Eigen::Vector3d T_map_graph(40.0, -7.0, 2.0);
  const double c = std::cos(-2.0), s = std::sin(-2.0);
  for (Keyframe& k : graph.keyframes) {
    const Eigen::Vector2d p = k.T_map_base.head<2>() - T_map_graph.head<2>();
    k.T_map_base = {c * p.x() - s * p.y(), s * p.x() + c * p.y(), k.T_map_base.z() - 2.0};
  }
  const auto found = find_georeference(graph, 5.0);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->z(), T_map_graph.z(), 0.3);
  for (Keyframe& k : graph.keyframes) k.positions.resize(0);
  EXPECT_FALSE(find_georeference(graph, 5.0));
}

}  // namespace
}  // namespace orchard::pose
