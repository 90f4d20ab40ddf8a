// SPDX-License-Identifier: BSD-3-Clause
#include "pose/prior_map/place_belief.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <utility>

#include "geometry/pose2.hpp"
#include "pose/pose_config.hpp"
#include "simulation/random.hpp"
#include "unit/central_difference.hpp"

namespace orchard::pose {
namespace {

using geometry::compose;
using test::central_difference;

const Eigen::Vector3d kStart(3.0, 2.0, 0.4);
constexpr double kRange_m = 8.0;

Eigen::Matrix3d start_covariance() {
  const Eigen::Matrix3d A =
      (Eigen::Matrix3d() << 0.1, 0, 0, -0.03, 0.08, 0, 0.01, 0.02, 0.03).finished();
  return A * A.transpose();
}

/// Trees here and there, far enough from one another that each trunk can be one of them only.
const std::vector<Eigen::Vector2d>& scattered() {
  static const std::vector<Eigen::Vector2d> trees{{6.0, 3.0},  {1.0, 6.5},  {-2.0, 1.0},
                                                  {4.0, -2.5}, {8.5, -1.0}, {7.0, 7.5}};
  return trees;
}

/// A row of trees along x, 2 m to the left of it.
std::vector<Eigen::Vector2d> row_of(int num, double spacing_m) {
  std::vector<Eigen::Vector2d> trees;
  for (int i = 0; i < num; ++i) trees.push_back({spacing_m * i, 2.0});
  return trees;
}

PriorMap map_of(const std::vector<Eigen::Vector2d>& trees) {
  std::vector<PriorLandmark> landmarks;
  for (const Eigen::Vector2d& p : trees) landmarks.push_back({p});
  return PriorMap(landmarks, 20.0);
}

std::vector<ScanObservation> seen_from(const std::vector<Eigen::Vector2d>& trees,
                                       const Eigen::Vector3d& T_map_base, double range_m) {
  std::vector<ScanObservation> observations;
  for (const Eigen::Vector2d& p : trees) {
    ScanObservation s;
    s.p_base = geometry::inverse_transform(T_map_base, p);
    s.covariance = 4e-4 * Eigen::Matrix2d::Identity();
    if (s.p_base.norm() < range_m) observations.push_back(s);
  }
  return observations;
}

/// A scanner that sees all around.
FieldOfView all_around(double range_m) {
  FieldOfView field(range_m);
  for (int degrees = 0; degrees < 360; ++degrees) {
    ScanObservation s;
    s.p_base = 2.0 * range_m * geometry::rotation(degrees * geometry::kPi / 180.0).col(0);
    field.learn({s});
  }
  return field;
}

/// The same scan again and again, with the weight of one pass of the trunks.
void pass(PlaceBelief& belief, const std::vector<ScanObservation>& observations,
          double range_m = kRange_m) {
  const FieldOfView field = all_around(range_m);
  constexpr double kTravel_m = 0.4;
  for (double way_m = 0.0; way_m < 2.0 * field.range_m(); way_m += kTravel_m) {
    belief.move(Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero(), kTravel_m);
    EXPECT_TRUE(belief.correct(observations, field));
  }
}

double sd(const PlaceBelief& belief, int axis) {
  return std::sqrt(belief.place().covariance(axis, axis));
}

TEST(PlaceBelief, AMotionCarriesTheCovarianceAsTheCentralDifferencesDo) {
  const Eigen::Vector3d next(0.8, -0.1, 0.3);
  const PriorMap map = map_of(scattered());
  PlaceBelief belief(map);
  belief.start(kStart, start_covariance());
  belief.move(next, 0.2 * start_covariance(), next.head<2>().norm());
  const auto by_pose = [&](const Eigen::VectorXd& x) { return compose(Eigen::Vector3d(x), next); };
  const auto by_motion = [&](const Eigen::VectorXd& x) {
    return compose(kStart, Eigen::Vector3d(x));
  };
  const Eigen::MatrixXd F = central_difference(by_pose, kStart).J;
  const Eigen::MatrixXd G = central_difference(by_motion, next).J;
  EXPECT_LT((belief.place().T_map_base - compose(kStart, next)).norm(), 1e-12);
  EXPECT_LT((belief.place().covariance - F * start_covariance() * F.transpose() -
             G * 0.2 * start_covariance() * G.transpose())
                .norm(),
            1e-9);
}

TEST(PlaceBelief, TrunksOfTheMapPullItThereAndMakeItNoSurerThanLeastSquaresDo) {
  const PriorMap map = map_of(scattered());
  const Eigen::Vector3d truth = kStart + Eigen::Vector3d(0.10, -0.06, 0.02);
  PlaceBelief belief(map);
  belief.start(kStart, start_covariance());
  const std::vector<ScanObservation> observations = seen_from(scattered(), truth, kRange_m);
  ASSERT_EQ(observations.size(), scattered().size());
  pass(belief, observations);
  EXPECT_LT((belief.place().T_map_base - truth).head<2>().norm(), 0.03);
  EXPECT_NEAR(belief.place().T_map_base.z(), truth.z(), 0.01);
  EXPECT_GT(belief.place().weight, 0.999);

  // The normal equations with partners known, each trunk once.
  Eigen::Matrix3d A = start_covariance().inverse();
  const double variance_m2 = 4e-4 + std::pow(PriorMapConfig::kLandmarkSd_m, 2);
  for (const ScanObservation& s : observations) {
    const auto place = [&](const Eigen::VectorXd& x) {
      return geometry::transform(Eigen::Vector3d(x), s.p_base);
    };
    const Eigen::MatrixXd H = central_difference(place, truth).J;
    A += H.transpose() * H / variance_m2;
  }
  const Eigen::Matrix3d P = A.inverse();
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_GT(sd(belief, axis), 0.9 * std::sqrt(P(axis, axis))) << axis;
    // Between two scans base may move unseen, so it stays less sure.
    EXPECT_LT(sd(belief, axis), 4.0 * std::sqrt(P(axis, axis))) << axis;
  }
}

TEST(PlaceBelief, WhatIsNotInTheMapDoesNotMakeItSure) {
  const PriorMap map = map_of(scattered());
  PlaceBelief belief(map);
  belief.start(kStart, start_covariance());
  std::vector<Eigen::Vector2d> leaves;
  for (int i = 0; i < 12; ++i) leaves.push_back({3.0 + 0.3 * i, 0.3});
  pass(belief, seen_from(leaves, kStart, kRange_m));
  EXPECT_LT((belief.place().T_map_base - kStart).norm(), 0.02);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_GT(sd(belief, axis), 0.9 * std::sqrt(start_covariance()(axis, axis))) << axis;
  }
}

TEST(PlaceBelief, PlacesThatFitAlikeKeepTheirSharesUntilTheEndOfTheRowDecides) {
  // Somewhere along a row of 21 trees 1.4 m apart; in its middle all trees look alike.
  const std::vector<Eigen::Vector2d> row = row_of(21, 1.4);
  const PriorMap map = map_of(row);
  const Eigen::Vector3d middle(14.0, 0.0, 0.0);
  PlaceBelief belief(map);
  belief.start(middle + Eigen::Vector3d(0.4, 0.0, 0.0),
               Eigen::Vector3d(4.0, 0.01, 1e-4).asDiagonal());
  constexpr double kNear_m = 3.0;  // so that no end of the row is in view
  pass(belief, seen_from(row, middle, kNear_m), kNear_m);
  EXPECT_LT(belief.place().weight, 0.6);
  const double here = belief.probability_at(middle);
  const double next = belief.probability_at(middle + Eigen::Vector3d(1.4, 0.0, 0.0));
  // The start's own preference, and no more: a Gaussian of 2 m, 0.4 m ahead.
  const auto density = [](double x_m) { return std::exp(-0.5 * x_m * x_m / 4.0); };
  EXPECT_NEAR(next / here, density(1.0) / density(0.4), 0.3);

  const Eigen::Vector3d to_end(14.0, 0.0, 0.0);
  belief.move(to_end, Eigen::Vector3d(0.01, 0.01, 1e-4).asDiagonal(), 0.0);
  for (int i = 0; i < 3; ++i) pass(belief, seen_from(row, compose(middle, to_end), kRange_m));
  EXPECT_GT(belief.place().weight, 0.99);
  EXPECT_NEAR(belief.place().T_map_base.x(), 28.0, 0.1);
}

TEST(PlaceBelief, AStartThatWasStatedOneTreeTooFarIsMendedByTheEndOfTheRow) {
  const std::vector<Eigen::Vector2d> row = row_of(21, 1.4);
  const PriorMap map = map_of(row);
  const Eigen::Vector3d truth(26.6, 0.0, 0.0), stated(25.2, 0.0, 0.0);
  PlaceBelief belief(map);
  belief.start_stated(stated, Eigen::Vector3d(0.01, 0.01, 1e-4).asDiagonal());
  EXPECT_NEAR(belief.place().weight, 0.9, 1e-9);
  const std::vector<ScanObservation> observations = seen_from(row, truth, kRange_m);
  for (int i = 0; i < 10; ++i) pass(belief, observations);
  EXPECT_GT(belief.probability_at(truth), 0.99);
  EXPECT_LT(belief.probability_at(stated), 0.01);
}

/// How probable the true place is after a motion that went one tree less far than was measured, and
/// the end of the row; `is_doubted`: nothing had confirmed that motion.
double found_after_a_mismatch(bool is_doubted) {
  const std::vector<Eigen::Vector2d> row = row_of(21, 1.4);
  const PriorMap map = map_of(row);
  const Eigen::Vector3d before(14.0, 0.0, 0.0), truth(26.6, 0.0, 0.0);
  const Eigen::Matrix3d P = Eigen::Vector3d(0.01, 0.01, 1e-4).asDiagonal();
  PlaceBelief belief(map);
  belief.start(before, P);
  constexpr double kNear_m = 3.0;  // so that no end of the row is in view
  pass(belief, seen_from(row, before, kNear_m), kNear_m);
  belief.move(Eigen::Vector3d(14.0, 0.0, 0.0), 0.1 * P, 0.0);
  for (int i = 0; i < 20 && is_doubted; ++i) belief.doubt_motion();  // no more often than it moved
  for (int i = 0; i < 10; ++i) pass(belief, seen_from(row, truth, kRange_m));
  EXPECT_LT(belief.num_places(), 100u);
  return belief.probability_at(truth);
}

TEST(PlaceBelief, AMotionThatScansFittedOneTreeTooFarIsMendedIfNothingConfirmedIt) {
  EXPECT_LT(found_after_a_mismatch(false), 0.01);
  EXPECT_GT(found_after_a_mismatch(true), 0.99);
}

TEST(PlaceBelief, StartedAnywhereItFindsTheOnlyPlaceThatFits) {
  // Two rows with gaps; half a turn of the block is another place, where the gaps do not fit.
  std::vector<Eigen::Vector2d> block;
  for (int i = 0; i < 12; ++i) {
    if (i != 3 && i != 4) block.push_back({1.4 * i, 0.0});
    if (i != 9) block.push_back({1.4 * i, 2.5});
  }
  const PriorMap map = map_of(block);
  const Eigen::Vector3d truth(5.6, 1.25, 0.3);
  const Eigen::Vector3d turned(15.4 - 5.6, 2.5 - 1.25, 0.3 - geometry::kPi);
  PlaceBelief belief(map);
  ASSERT_TRUE(belief.start_anywhere(2.1));
  EXPECT_LT(belief.place().weight, 0.01);
  pass(belief, seen_from(block, truth, kRange_m));
  EXPECT_GT(belief.probability_at(truth), 0.99);
  EXPECT_LT(belief.probability_at(turned), 0.01);
  EXPECT_LT((belief.place().T_map_base - truth).norm(), 0.1);
  EXPECT_GT(belief.place().seen, 0.8);
}

/// Six rows of trees along x, 4 m apart, each tree off its place by some decimetres.
std::vector<Eigen::Vector2d> planted(std::uint64_t seed) {
  simulation::Random random(seed, simulation::Stream::kScene);
  std::vector<Eigen::Vector2d> trees;
  for (int row = 0; row < 6; ++row) {
    for (int i = 0; i < 55; ++i) {
      trees.push_back({2.5 * i + random.normal(0.0, 0.15), 4.0 * row + random.normal(0.0, 0.15)});
    }
  }
  return trees;
}

/// Drives 120 m along the middle of an orchard with a map, from the start that is stated; counts
/// the corrections after which the place has passed and failed the test.
std::pair<int, int> driven(const std::vector<Eigen::Vector2d>& trees, const PriorMap& map) {
  PlaceBelief belief(map);
  Eigen::Vector3d truth(5.0, 10.0, 0.0);
  belief.start(truth, Eigen::Vector3d(0.04, 0.04, 1e-4).asDiagonal());
  const Eigen::Vector3d step(0.4, 0.0, 0.0);
  std::pair<int, int> passed_failed(0, 0);
  for (; truth.x() < 125.0; truth += step) {
    belief.move(step, Eigen::Vector3d(1e-5, 1e-5, 1e-7).asDiagonal(), step.x());
    belief.correct(seen_from(trees, truth + step, kRange_m), all_around(kRange_m));
    passed_failed.first += belief.pattern().is_of_map();
    passed_failed.second += belief.pattern().is_elsewhere();
  }
  return passed_failed;
}

TEST(PatternEvidence, APlaceOfTheMapPassesAndAnotherOrchardOfThePatternNeverDoes) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const PriorMap own = map_of(planted(seed));
    const auto [passed, failed] = driven(planted(seed), own);
    EXPECT_GT(passed, 0) << seed;
    EXPECT_EQ(failed, 0) << seed;
    EXPECT_EQ(driven(planted(seed + 50), own).first, 0) << seed;
  }
}

/// The probability of the true place and of one a row nearer to the map, after a drive along trees
/// that the earlier drive did not see: it made a map of the first three rows of six.
std::pair<double, double> driven_beside(std::uint64_t seed, bool knows_what_was_seen) {
  std::vector<PriorLandmark> landmarks;
  for (const Eigen::Vector2d& p : planted(seed)) {
    if (p.y() < 10.0) landmarks.push_back({p});
  }
  PriorMapData earlier(landmarks);
  for (double x_m = -20.0; x_m < 160.0 && knows_what_was_seen; x_m += 1.0) {
    for (double y_m = -10.0; y_m < 10.0; y_m += 1.0) earlier.seen_m.push_back({x_m, y_m});
  }
  const PriorMap map(earlier, 20.0);
  PlaceBelief belief(map);
  Eigen::Vector3d truth(5.0, 14.0, 0.0);
  belief.start_stated(truth, Eigen::Vector3d(0.01, 0.01, 1e-4).asDiagonal());
  const Eigen::Vector3d step(0.4, 0.0, 0.0);
  for (; truth.x() < 45.0; truth += step) {
    belief.move(step, Eigen::Vector3d(1e-5, 1e-5, 1e-7).asDiagonal(), step.x());
    belief.correct(seen_from(planted(seed), truth + step, kRange_m), all_around(kRange_m));
  }
  return {belief.probability_at(truth),
          belief.probability_at(truth - Eigen::Vector3d(0.0, 4.0, 0.0))};
}

TEST(PlaceBelief, BesideTheMapItDoesNotMoveIntoItBecauseRowsAreAlike) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const auto [there, aside] = driven_beside(seed, true);
    EXPECT_GT(there, 0.9) << seed;
    EXPECT_LT(aside, 0.05) << seed;
    // Not knowing where the earlier drive looked, it takes what it sees for what is in the map.
    EXPECT_LT(driven_beside(seed, false).first, there) << seed;
  }
}

TEST(PlaceBelief, AMapOfTooManyPlacesIsLeftToTheSearch) {
  PriorMap map = map_of(row_of(4000, 1.4));
  PlaceBelief belief(map);
  EXPECT_FALSE(belief.start_anywhere(2.1));
}

TEST(PlaceBelief, WithoutATrunkInSightItSpreadsAndIsGivenUp) {
  const PriorMap map = map_of(row_of(21, 1.4));
  PlaceBelief belief(map);
  belief.start({5.0, 30.0, 0.0}, start_covariance());
  EXPECT_FALSE(belief.is_spread_out());
  const Eigen::Matrix3d per_metre = Eigen::Vector3d(0.04, 0.04, 4e-3).asDiagonal();
  int way_m = 0;
  for (; way_m < 500 && !belief.is_spread_out(); ++way_m) {
    belief.move({1.0, 0.0, 0.0}, per_metre, 1.0);
    belief.correct({}, all_around(kRange_m));
  }
  EXPECT_GT(way_m, 20);
  EXPECT_LT(way_m, 500);
  EXPECT_LE(belief.num_places(), 20'000u);
}

}  // namespace
}  // namespace orchard::pose
