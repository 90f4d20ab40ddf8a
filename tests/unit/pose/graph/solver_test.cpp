// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/pose2.hpp"
#include "pose/graph/georeference.hpp"
#include "pose/graph/solver.hpp"
#include "pose/graph/submaps.hpp"
#include "simulation/random.hpp"
#include "unit/nees_band.hpp"

namespace orchard::pose {
namespace {

using geometry::between;
using geometry::compose;
using geometry::compose_jacobian_first;
using geometry::compose_jacobian_second;
using geometry::inverse_transform;
using geometry::transform;

// Truth: a straight drive at 2 m/s; fixes with an error of known kind: white, or a Gauss-Markov
// process of 60 s in its exact discrete form.

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

TEST(PoseFixes, ThoseBesideThePathAreCounted) {
  SlamGraph graph;
  for (int i = 0; i < 20; ++i) {
    Keyframe keyframe;
    keyframe.utime = 1'000'000 * (i + 1);
    keyframe.T_map_base = {1.0 * i, 0.0, 0.0};
    graph.keyframes.push_back(keyframe);
    AbsolutePosition position;
    position.utime = keyframe.utime;
    position.p_map = {1.0 * i, i >= 10 && i < 15 ? 0.5 : 0.01};
    position.covariance = 0.02 * 0.02 * Eigen::Matrix2d::Identity();
    add_position(position, graph);
  }
  const RejectedFixes off = rejected_fixes(graph, false);
  EXPECT_EQ(off.num_fixes, 20);
  EXPECT_EQ(off.num_left_out, 5);
  EXPECT_NEAR(off.longest_s, 4.0, 1e-9);
  EXPECT_EQ(rejected_fixes(graph).num_fixes, 0) << "none is of a receiver";
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

/// A path of four keyframes of which the last two see one trunk, with poses that are off. Nothing
/// measures the motion between them: `motion_sd` is its standard deviation.
SlamGraph one_trunk_in_the_dark(std::uint64_t seed, double motion_sd) {
  simulation::Random random(seed);
  SlamGraph graph;
  graph.calibrations.emplace_back(OdometryCalibration::Zero());
  graph.landmarks.resize(1);
  graph.landmarks[0].p_map = {3.0 + random.uniform(), 2.0 + random.uniform()};
  for (int k = 0; k < 4; ++k) {
    Keyframe keyframe;
    keyframe.T_map_base = {k + 0.3 * random.uniform(), 0.3 * random.uniform(), random.uniform()};
    keyframe.motion.delta = {1.0, 0.0, 0.0};
    keyframe.motion.covariance = motion_sd * motion_sd * Eigen::Matrix3d::Identity();
    graph.keyframes.push_back(keyframe);
    if (k < 2) continue;
    const Eigen::Vector2d p_base(2.0 + random.uniform(), random.uniform());
    graph.add_observation(k, 0, p_base, 1e-8 * Eigen::Matrix2d::Identity(), 0.0);
  }
  return graph;
}

/// Twelve keyframes on a curve past nine trunks, with noisy measurements and one gross error.
SlamGraph curve_past_trunks(std::uint64_t seed) {
  simulation::Random random(seed);
  SlamGraph graph;
  graph.calibrations.emplace_back(OdometryCalibration::Zero());
  std::vector<Eigen::Vector2d> trunks;
  for (int l = 0; l < 9; ++l) trunks.emplace_back(1.5 * l - 2.0, l % 2 == 0 ? 2.0 : -1.5);
  graph.landmarks.resize(trunks.size());
  for (std::size_t l = 0; l < trunks.size(); ++l) {
    graph.landmarks[l].p_map = trunks[l] + 0.05 * Eigen::Vector2d(random.normal(), random.normal());
  }
  Eigen::Vector3d T = Eigen::Vector3d::Zero();
  const Eigen::Vector3d step(0.8, 0.0, 0.1);
  for (int k = 0; k < 12; ++k) {
    Keyframe keyframe;
    keyframe.T_map_base = T;
    if (k > 0) {
      keyframe.motion.delta =
          step + 0.01 * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
      keyframe.motion.covariance = 1e-4 * Eigen::Matrix3d::Identity();
      keyframe.motion.calibration_jacobian = step.asDiagonal();
      keyframe.T_map_base += 0.02 * Eigen::Vector3d(random.normal(), random.normal(), 0.0);
    }
    graph.keyframes.push_back(keyframe);
    for (int l = 0; l < 9; ++l) {
      Eigen::Vector2d p_base = geometry::inverse_transform(T, trunks[l]);
      if (p_base.norm() > 5.0) continue;
      p_base += 0.02 * Eigen::Vector2d(random.normal(), random.normal());
      if (k == 5 && l == 3) p_base.x() += 0.5;
      graph.add_observation(k, l, p_base, 4e-4 * Eigen::Matrix2d::Identity(), 0.0);
    }
    T = geometry::compose(T, step);
  }
  return graph;
}

TEST(SlamSolver, AWindowOfTheWholeGraphIsTheWholeGraph) {
  const SlamConfig config;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    // The first keyframe is the origin of both; only the window leaves out its observations.
    SlamGraph window = curve_past_trunks(seed);
    for (const SlamObservation& o : window.keyframes[0].observations) {
      std::vector<int>& seen_by = window.landmarks[o.landmark].keyframes;
      seen_by.erase(seen_by.begin());
    }
    window.keyframes[0].observations.edit().clear();
    SlamGraph whole = window;
    const WindowSolution solution =
        solve_window(window, 1, CalibrationPrior::initial(config), config);
    ASSERT_TRUE(solve_graph(whole, false, config).solved);
    // A window ends when an iteration gains 1e-4 of a cost of about 50: a tenth of a sigma of 2 cm.
    EXPECT_LT((window.calibrations[0] - whole.calibrations[0]).norm(), 2e-3);
    for (std::size_t k = 0; k < whole.keyframes.size(); ++k) {
      const Eigen::Vector3d& a = window.keyframes[k].T_map_base;
      EXPECT_LT((a - whole.keyframes[k].T_map_base).norm(), 2e-3) << "keyframe " << k;
    }
    for (std::size_t l = 0; l < whole.landmarks.size(); ++l) {
      const Eigen::Vector2d& a = window.landmarks[l].p_map;
      EXPECT_LT((a - whole.landmarks[l].p_map).norm(), 2e-3) << "landmark " << l;
    }
    const Eigen::Matrix3d& P = whole.keyframes.back().covariance;
    EXPECT_LT((solution.local_covariance - P).norm(), 0.01 * P.norm());
  }
}

TEST(SlamSolver, AGraphBeyondItsLimitsIsLeftAsItWas) {
  const SlamConfig config;
  const SlamGraph before = curve_past_trunks(1);
  std::size_t num_observations = 0;
  for (const Keyframe& k : before.keyframes) num_observations += k.observations.size();
  SolveLimits little_memory, little_time, enough;
  little_memory.num_entries = 6 * num_observations - 1;
  little_time.factor_work = 100.0;  // less than that of three dense poses
  enough.num_entries = 6 * num_observations;
  enough.factor_work = 38 * 38 * 38 / 3.0;  // a dense matrix of 12 poses and a calibration
  for (const SolveLimits& limits : {little_memory, little_time}) {
    SlamGraph graph = before;
    const GraphSolution solution = solve_graph(graph, false, config, limits);
    EXPECT_TRUE(solution.is_beyond_limits);
    EXPECT_FALSE(solution.solved);
    for (std::size_t k = 0; k < graph.keyframes.size(); ++k) {
      EXPECT_EQ(graph.keyframes[k].T_map_base, before.keyframes[k].T_map_base) << "keyframe " << k;
    }
  }
  SlamGraph graph = before;
  const GraphSolution solution = solve_graph(graph, false, config, enough);
  EXPECT_FALSE(solution.is_beyond_limits);
  EXPECT_TRUE(solution.solved);
}

TEST(SlamSolver, AWindowThatIsNotSolvedLeavesTheGraphAsItWas) {
  // One trunk tells two of three numbers of a pose: with motions that say nothing, whether the
  // information can be inverted at all is a matter of rounding.
  int num_unsolved = 0;
  int num_solved = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const SlamGraph before = one_trunk_in_the_dark(seed, seed % 2 == 0 ? 1e9 : 0.1);
    SlamGraph graph = before;
    const WindowSolution solution = solve_window(graph, 1, CalibrationPrior{}, SlamConfig{});
    if (solution.solved) {
      ++num_solved;
      EXPECT_NE(graph.keyframes[3].T_map_base, before.keyframes[3].T_map_base);
      continue;
    }
    ++num_unsolved;
    for (std::size_t k = 0; k < graph.keyframes.size(); ++k) {
      EXPECT_EQ(graph.keyframes[k].T_map_base, before.keyframes[k].T_map_base) << "keyframe " << k;
    }
    EXPECT_EQ(graph.landmarks[0].p_map, before.landmarks[0].p_map);
    EXPECT_EQ(graph.calibrations[0], before.calibrations[0]);
  }
  EXPECT_GE(num_unsolved, 5);
  EXPECT_GE(num_solved, 5);
}

// Truth: a path along a row of trees, seen without error; then bent, as a drift would.

constexpr int kNumKeyframes = 121;
constexpr double kStepM = 0.5;

Eigen::Vector2d tree(int l) { return {2.0 * l, l % 2 == 0 ? 2.0 : -2.0}; }

/// A quarter of a turn over the whole path.
Eigen::Vector3d motion_true() { return {kStepM, 0.0, 0.5 * geometry::kPi / kNumKeyframes}; }

/// Keyframes where they are, what each sees within 6 m, and odometry without error.
SlamGraph world() {
  SlamGraph graph;
  graph.calibrations.push_back(OdometryCalibration::Zero());
  for (int l = 0; l < 40; ++l) {
    SlamLandmark landmark;
    landmark.p_map = tree(l);
    landmark.confirmed = true;
    graph.landmarks.push_back(landmark);
  }
  for (int k = 0; k < kNumKeyframes; ++k) {
    Keyframe keyframe;
    keyframe.utime = 500000 * k;
    if (k > 0) {
      const Keyframe& before = graph.keyframes.back();
      keyframe.T_map_base = compose(before.T_map_base, motion_true());
      keyframe.travel_m = before.travel_m + kStepM;
      keyframe.motion.delta = motion_true();
      keyframe.motion.covariance = Eigen::Vector3d(1e-4, 1e-4, 1e-5).asDiagonal();
      keyframe.motion.travel_m = kStepM;
    }
    graph.keyframes.push_back(keyframe);
    for (int l = 0; l < 40; ++l) {
      const Eigen::Vector2d p = inverse_transform(keyframe.T_map_base, tree(l));
      if (p.norm() < 6.0) graph.add_observation(k, l, p, 4e-4 * Eigen::Matrix2d::Identity(), 0.005);
    }
  }
  return graph;
}

// Before the first tree the way is what the wheels say, off by a twentieth: 0.3 m over 6 m.
TEST(Submaps, WhatOnlyTheWheelsSayIsNoRigidShape) {
  SlamGraph graph = world();
  const auto num_before = [](const SlamGraph& of) {
    const SubmapGraph submaps = submaps_of(of, SlamConfig{});
    return std::count_if(submaps.keyframes.begin(), submaps.keyframes.end(),
                         [](int k) { return k > 0 && k <= 12; });
  };
  for (Keyframe& k : graph.keyframes) k.motion.calibration_jacobian(0, 0) = kStepM;
  EXPECT_EQ(num_before(graph), 0);
  for (int k = 0; k <= 12; ++k) graph.keyframes[k].observations.edit().clear();
  EXPECT_GE(num_before(graph), 4);
}

TEST(Submaps, SumUpTheirKeyframesObservations) {
  const SlamGraph graph = world();
  SlamConfig config;
  config.submap_length_m = 5.0;
  const SubmapGraph submaps = submaps_of(graph, config);
  ASSERT_LT(submaps.graph.keyframes.size(), 17u);  // the path leaves the trees behind
  ASSERT_GT(submaps.graph.keyframes.size(), 10u);
  int num_scans = 0, num_scans_then = 0;
  for (const Keyframe& k : graph.keyframes) {
    for (const SlamObservation& s : k.observations) num_scans += s.num_scans;
  }
  for (std::size_t i = 0; i < submaps.graph.keyframes.size(); ++i) {
    const Keyframe& submap = submaps.graph.keyframes[i];
    for (const SlamObservation& s : submap.observations) {
      num_scans_then += s.num_scans;
      // the same place, from the middle of the submap
      EXPECT_LT((transform(submap.T_map_base, s.position()) - tree(s.landmark)).norm(), 1e-9);
    }
    if (i == 0) continue;
    const Eigen::Vector3d apart =
        between(submaps.graph.keyframes[i - 1].T_map_base, submap.T_map_base);
    EXPECT_LT((submap.motion.delta - apart).norm(), 1e-9);
    EXPECT_NEAR(submap.motion.travel_m, submap.travel_m - submaps.graph.keyframes[i - 1].travel_m,
                1e-9);
  }
  EXPECT_EQ(num_scans_then, num_scans);
}

TEST(Submaps, TheDerivativeByTheOdometryCalibrationIsKept) {
  // speed and turn too large by a fraction each: the motion over a submap as with one long keyframe
  SlamGraph graph;
  graph.calibrations.push_back(OdometryCalibration::Zero());
  RelativeMotion whole;
  Keyframe keyframe;
  graph.keyframes.push_back(keyframe);
  for (int k = 1; k <= 8; ++k) {
    keyframe.motion = RelativeMotion();
    for (int step = 0; step < 10; ++step) {
      keyframe.motion.drive(1.0, 0.2, {1e-4, 0.0, 1e-5}, 0.05);
      whole.drive(1.0, 0.2, {1e-4, 0.0, 1e-5}, 0.05);
    }
    keyframe.travel_m += 0.5;
    graph.keyframes.push_back(keyframe);
  }
  SlamConfig config;
  config.submap_length_m = 1.9;
  const SubmapGraph submaps = submaps_of(graph, config);
  RelativeMotion sum;
  Eigen::Matrix3d E = Eigen::Matrix3d::Zero();
  Eigen::Vector3d T = Eigen::Vector3d::Zero();
  for (std::size_t i = 1; i < submaps.graph.keyframes.size(); ++i) {
    const RelativeMotion& m = submaps.graph.keyframes[i].motion;
    E = compose_jacobian_first(T, m.delta) * E +
        compose_jacobian_second(T) * m.calibration_jacobian;
    T = compose(T, m.delta);
  }
  // the last pose stands before the end: compare over the same way
  RelativeMotion same;
  const int last = submaps.keyframes.back();
  for (int step = 0; step < 10 * last; ++step) same.drive(1.0, 0.2, {1e-4, 0.0, 1e-5}, 0.05);
  EXPECT_LT((T - same.delta).norm(), 1e-9);
  EXPECT_LT((E - same.calibration_jacobian).norm(), 1e-9);
}

TEST(Submaps, BlindMotionEndsASubmap) {
  SlamGraph graph = world();
  for (Keyframe& k : graph.keyframes) k.motion.covariance *= 1e-4;
  graph.keyframes[43].motion.covariance(0, 0) = 0.3 * 0.3;
  SlamConfig config;
  config.submap_length_m = 100.0;
  const SubmapGraph submaps = submaps_of(graph, config);
  ASSERT_EQ(submaps.graph.keyframes.size(), 2u);
  EXPECT_EQ(submaps.submap_of[42], 0);
  EXPECT_EQ(submaps.submap_of[43], 1);
}

TEST(Submaps, ADriftIsTakenOutAndTheKeyframesFollow) {
  const SlamGraph truth = world();
  SlamGraph graph = truth;
  // Each 5 m of path are right in themselves; where two meet, the path bends.
  for (int k = 1; k < kNumKeyframes; ++k) {
    Eigen::Vector3d motion = motion_true();
    if (k % 11 == 0) motion.z() += 0.01;
    graph.keyframes[k].T_map_base = compose(graph.keyframes[k - 1].T_map_base, motion);
  }
  for (std::size_t l = 0; l < graph.landmarks.size(); ++l) {
    graph.update_landmark(static_cast<int>(l), true);
  }
  SlamConfig config;
  config.submap_length_m = 5.0;
  SubmapGraph submaps = submaps_of(graph, config);
  ASSERT_TRUE(solve_graph(submaps.graph, false, config).solved);
  const SlamGraph drifted = graph;
  back_substitute(submaps, graph);
  double before_m = 0.0, after_m = 0.0;
  for (int k = 1; k < kNumKeyframes; ++k) {
    const Eigen::Vector3d& T = truth.keyframes[k].T_map_base;
    const auto off_m = [&](const SlamGraph& g) {
      return (g.keyframes[k].T_map_base - T).head<2>().norm();
    };
    before_m = std::max(before_m, off_m(drifted));
    after_m = std::max(after_m, off_m(graph));
    // no step where one submap ends and the next begins
    const Eigen::Vector3d step =
        between(graph.keyframes[k - 1].T_map_base, graph.keyframes[k].T_map_base);
    EXPECT_NEAR(step.x(), kStepM, 0.02);
    EXPECT_NEAR(step.y(), 0.0, 0.02);
    if (k > 10) {
      EXPECT_GT(graph.keyframes[k].covariance(0, 0), 0.0);
    }
  }
  EXPECT_GT(before_m, 1.0);
  EXPECT_LT(after_m, 0.1 * before_m);
  for (int l = 0; l < 20; ++l) {
    if (graph.landmarks[l].keyframes.empty()) continue;
    EXPECT_LT((graph.landmarks[l].p_map - tree(l)).norm(), 0.1 * before_m) << "landmark " << l;
  }
}

}  // namespace
}  // namespace orchard::pose
