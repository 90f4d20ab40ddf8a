// SPDX-License-Identifier: BSD-3-Clause
#include "pose/filter/fix_hypotheses.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "pose/graph/georeference.hpp"

namespace orchard::pose {
namespace {

// Truth: probabilities by Bayes' rule, worked by hand.

DisplacementHistories displaced_once(std::int64_t begin_utime, std::int64_t end_utime) {
  DisplacementHistories histories;
  histories.begin(begin_utime, true);
  histories.extend(end_utime);
  return histories;
}

TEST(DisplacementHistories, AMergeKeepsBothByTheirOdds) {
  DisplacementHistories histories = displaced_once(0, 5);
  histories.merge(DisplacementHistories(), 0.5);
  ASSERT_EQ(histories.all().size(), 2U);
  EXPECT_DOUBLE_EQ(histories.all()[0].probability, 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(histories.all()[1].probability, 1.0 / 3.0);
  EXPECT_EQ(histories.likeliest().size(), 1U);
}

TEST(DisplacementHistories, TheSameHistoryOnTwoWaysAddsUp) {
  DisplacementHistories histories = displaced_once(0, 5);
  histories.merge(DisplacementHistories(), 0.5);
  histories.merge(DisplacementHistories(), 1.0);
  ASSERT_EQ(histories.all().size(), 2U);
  EXPECT_TRUE(histories.likeliest().empty());
  EXPECT_DOUBLE_EQ(histories.all()[0].probability, 1.0 / 6.0 + 1.0 / 2.0);
}

TEST(DisplacementHistories, WhatComesLaterBelongsToEach) {
  DisplacementHistories histories = displaced_once(0, 5);
  histories.merge(DisplacementHistories(), 0.5);
  histories.begin(20, false);
  histories.extend(30);
  const DisplacedTime later{20, 30, false};
  for (const DisplacementHistory& history : histories.all()) {
    EXPECT_EQ(history.displaced.back(), later);
  }
  EXPECT_EQ(histories.all()[0].displaced.size(), 2U);
  EXPECT_EQ(histories.all()[1].displaced.size(), 1U);
}

TEST(DisplacementHistories, TheUnlikelyIsForgottenAndTheRestSumsToOne) {
  DisplacementHistories histories;
  for (int i = 1; i <= 30; ++i) histories.merge(displaced_once(i, i + 1), 0.2);
  double sum = 0.0;
  for (const DisplacementHistory& history : histories.all()) sum += history.probability;
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_LT(histories.all().size(), 10U);
  histories.merge(displaced_once(99, 100), 1e-3);
  for (const DisplacementHistory& history : histories.all()) {
    EXPECT_NE(history.displaced.front().begin_utime, 99);
  }
}

// Truth: a robot on a straight line with exact wheels, and positions with the noise that they
// state; some are displaced by a constant.

constexpr double kPeriod_s = 0.2;
constexpr double kSpeed_mps = 2.0;
constexpr double kFixSd_m = 0.3;

class Drive {
 public:
  explicit Drive(std::uint64_t seed) : random_(seed) {
    Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
    P.diagonal() << 0.01, 0.01, 1e-4;
    hypotheses.place(Eigen::Vector3d::Zero(), P, 0, true);
  }

  /// Drives on; `offset_m`: displacement of positions by the time since the call [s].
  void on(double duration_s, const std::function<Eigen::Vector2d(double)>& offset_m) {
    for (double t_s = 0.0; t_s < duration_s - 1e-9; t_s += kPeriod_s) {
      MotionStep step;
      step.dt_s = kPeriod_s;
      step.speed_mps = kSpeed_mps;
      step.speed_sd_mps = 0.01;
      step.yaw_rate_sd_radps = 0.001;
      hypotheses.move(step);
      x_m += kPeriod_s * kSpeed_mps;
      utime += 200'000;
      PositionObservation seen;
      const double east = normal_(random_), north = normal_(random_);
      seen.p_map_m =
          Eigen::Vector2d(x_m, 0.0) + kFixSd_m * Eigen::Vector2d(east, north) + offset_m(t_s);
      seen.covariance = kFixSd_m * kFixSd_m * Eigen::Matrix2d::Identity();
      seen.is_gnss = true;
      hypotheses.correct(seen, utime);
    }
  }

  /// Makes the position unknown by `sd_m` in a minute without positions.
  void gap(double sd_m) {
    utime += 60'000'000;
    for (FixHypotheses::Hypothesis& h : hypotheses.all()) {
      h.filter.inflate_covariance(sd_m * sd_m, 0.01);
    }
  }

  double error_m() const {
    return (hypotheses.best().filter.p_map_m({0.0, 0.0}) - Eigen::Vector2d(x_m, 0.0)).norm();
  }

  FixHypotheses hypotheses{FusionConfig{}};
  double x_m = 0.0;
  std::int64_t utime = 0;

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

Eigen::Vector2d none(double) { return {0.0, 0.0}; }

TEST(FixHypotheses, DirectPositionsAreNeverLeftOut) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Drive drive(seed);
    drive.on(60.0, none);
    EXPECT_TRUE(drive.hypotheses.best().histories.likeliest().empty()) << "seed " << seed;
    EXPECT_LT(drive.error_m(), 0.5);
  }
}

TEST(FixHypotheses, AReflectionIsKnownFromItsFirstToItsLastPosition) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Drive drive(seed);
    drive.on(20.0, none);
    const std::int64_t begin = drive.utime;
    drive.on(30.0, [](double t_s) { return Eigen::Vector2d(t_s < 6.0 ? 8.0 : 0.0, 0.0); });
    const auto& displaced = drive.hypotheses.best().histories.likeliest();
    ASSERT_EQ(displaced.size(), 1U) << "seed " << seed;
    EXPECT_EQ(displaced[0].begin_utime, begin + 200'000);
    EXPECT_EQ(displaced[0].end_utime, begin + 6'000'000);
    EXPECT_FALSE(drive.hypotheses.best().is_displaced);
    EXPECT_LT(drive.error_m(), 0.5);
  }
}

TEST(FixHypotheses, LaterPositionsTellThatTheFirstAfterAGapWereReflected) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Drive drive(seed);
    drive.on(20.0, none);
    drive.gap(15.0);
    const std::int64_t begin = drive.utime;
    drive.on(3.0, [](double) { return Eigen::Vector2d(8.0, 0.0); });
    // Nothing contradicts them yet.
    EXPECT_FALSE(drive.hypotheses.best().is_displaced) << "seed " << seed;
    // Then they stay where a displacement rarely lasts.
    drive.on(60.0, none);
    const auto& displaced = drive.hypotheses.best().histories.likeliest();
    ASSERT_EQ(displaced.size(), 1U) << "seed " << seed;
    EXPECT_GT(displaced[0].begin_utime, begin);
    EXPECT_EQ(displaced[0].end_utime, begin + 3'000'000);
    EXPECT_LT(drive.error_m(), 0.6);
  }
}

/// Returns the probability of all histories with a displaced time that begins within these.
double probability_displaced(const FixHypotheses& hypotheses, std::int64_t from, std::int64_t to) {
  double sum = 0.0;
  for (const DisplacementHistory& history : hypotheses.histories()) {
    for (const DisplacedTime& time : history.displaced) {
      if (time.begin_utime > from && time.begin_utime <= to) {
        sum += history.probability;
        break;
      }
    }
  }
  return sum;
}

TEST(FixHypotheses, WhatPositionsCannotDecideStaysOpenForGood) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Drive drive(seed);
    drive.on(20.0, none);
    drive.gap(15.0);
    const std::int64_t first = drive.utime;
    drive.on(10.0, [](double) { return Eigen::Vector2d(4.0, 4.0); });
    const std::int64_t second = drive.utime;
    drive.on(10.0, [](double) { return Eigen::Vector2d(-4.0, -4.0); });
    // As long, and as far from what the wheels say: one of both was reflected.
    for (const bool later : {false, true}) {
      if (later) {  // after one more gap the present no longer depends on it
        drive.gap(100.0);
        drive.on(60.0, none);
      }
      const double p_first = probability_displaced(drive.hypotheses, first, second);
      const double p_second = probability_displaced(drive.hypotheses, second, second + 10'000'000);
      EXPECT_GT(p_first, 0.1) << "seed " << seed << (later ? ", later" : "");
      EXPECT_GT(p_second, 0.1) << "seed " << seed << (later ? ", later" : "");
    }
  }
}

TEST(FixHypotheses, ARobotThatWasCarriedIsFollowed) {
  Drive drive(1);
  drive.on(20.0, none);
  drive.on(120.0, [](double) { return Eigen::Vector2d(50.0, 0.0); });
  EXPECT_FALSE(drive.hypotheses.best().is_displaced);
  EXPECT_NEAR(drive.error_m(), 50.0, 1.0);
}

// Truth: a straight path that is known, and a receiver with white noise, an error that wanders in a
// minute, and two reflections of constant displacement.

constexpr double kClaimed_m = 1.8, kNoise_m = 0.5, kWander_m = 1.7, kWander_s = 60.0;

Eigen::Vector2d reflection_at(double time_s) {
  if (time_s > 100.0 && time_s < 107.0) return {4.0, -3.0};
  if (time_s > 199.0 && time_s < 206.0) return {-12.0, 5.0};  // from the end of a gap on
  return Eigen::Vector2d::Zero();
}

SlamGraph graph_of(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  SlamGraph graph;
  graph.georeferenced = true;
  Eigen::Vector2d wander(kWander_m * normal(random), kWander_m * normal(random));
  const double kept = std::exp(-kPeriod_s / kWander_s);
  for (int i = 0; i < 1500; ++i) {
    const double time_s = i * kPeriod_s;
    for (double& axis : wander) {
      axis = kept * axis + kWander_m * std::sqrt(1.0 - kept * kept) * normal(random);
    }
    Keyframe keyframe;
    keyframe.utime = static_cast<std::int64_t>(1e6 * time_s);
    keyframe.T_map_base = {2.0 * time_s, 0.0, 0.0};
    graph.keyframes.push_back(keyframe);
    if (time_s > 160.0 && time_s < 200.0) continue;
    AbsolutePosition fix;
    fix.utime = keyframe.utime;
    fix.is_gnss = true;
    fix.covariance = kClaimed_m * kClaimed_m * Eigen::Matrix2d::Identity();
    fix.p_map = keyframe.T_map_base.head<2>() + wander + reflection_at(time_s);
    fix.p_map += kNoise_m * Eigen::Vector2d(normal(random), normal(random));
    add_position(fix, graph);
  }
  return graph;
}

TEST(DisplacedFixes, ReflectedFixesAreMarkedAndNoOthers) {
  int missed = 0, wrong = 0, num = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SlamGraph graph = graph_of(seed);
    mark_displaced_fixes(graph);
    for (const Keyframe& k : graph.keyframes) {
      for (const AbsolutePosition& fix : k.positions) {
        const bool is_reflected = reflection_at(1e-6 * static_cast<double>(fix.utime)).norm() > 0.0;
        num += is_reflected ? 1 : 0;
        missed += is_reflected && !fix.is_displaced ? 1 : 0;
        wrong += !is_reflected && fix.is_displaced ? 1 : 0;
      }
    }
  }
  EXPECT_LT(missed, num / 50);
  EXPECT_LT(wrong, num / 50);
}

TEST(DisplacedFixes, AGraphWithoutGeoreferenceIsLeftAlone) {
  SlamGraph graph = graph_of(1);
  graph.georeferenced = false;
  mark_displaced_fixes(graph);
  for (const Keyframe& k : graph.keyframes) {
    for (const AbsolutePosition& fix : k.positions) EXPECT_FALSE(fix.is_displaced);
  }
}

}  // namespace
}  // namespace orchard::pose
