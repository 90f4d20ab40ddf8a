// SPDX-License-Identifier: BSD-3-Clause
#include "detection/adaptation/adaptation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace orchard::detection {
namespace {

constexpr double kWidth_m = 0.12;

/// A drive past things 2 m apart at 1 m/s, one after the other, ten scans a second.
class Drive {
 public:
  explicit Drive(const AdaptationConfig& config) : adaptation_(config, kWidth_m) {}

  /// `observation_of(thing number, time)` says what a scan shows; a thing is seen for two seconds.
  void run(double duration_s,
           const std::function<AdaptationObservation(int, double)>& observation_of) {
    for (const double end_s = now_s_ + duration_s; now_s_ < end_s; now_s_ += 0.1) {
      const int thing = static_cast<int>(now_s_ / 2.0);
      AdaptationObservation observation = observation_of(thing, now_s_);
      observation.x_m = 2.0 - (now_s_ - 2.0 * thing);
      observation.y_m = 1.0;
      const auto utime = static_cast<std::int64_t>(std::llround(now_s_ * 1e6)) + 1;
      for (const AdaptationStep& step : adaptation_.add(utime, {observation}))
        steps_.push_back(step);
    }
  }
  const AdaptedModel& model() const { return adaptation_.model(); }
  const std::vector<AdaptationStep>& steps() const { return steps_; }
  int count(AdaptationAction action, AdaptationReason reason) const {
    int n = 0;
    for (const auto& step : steps_) n += step.action == action && step.reason == reason;
    return n;
  }

 private:
  Adaptation adaptation_;
  double now_s_ = 0.0;
  std::vector<AdaptationStep> steps_;
};

AdaptationConfig referenced() {
  AdaptationConfig config;
  config.enabled = true;
  config.reference_blue = 0.6;
  config.reference_red = 1.3;
  config.reference_green = 110;
  return config;
}

AdaptationObservation tree(double width_m = kWidth_m, const Light& light = {}) {
  AdaptationObservation observation;
  observation.width_m = width_m;
  observation.roc_laser = 0.9;
  observation.roc_colour = 0.9;
  observation.roc_vision = 0.8;
  observation.light = vision::WindowLight{std::log(0.6) + light.blue, std::log(1.3) + light.red,
                                          std::log(110.0) + light.green};
  return observation;
}

/// Scatter of trees from a generator of whole numbers: the same on every machine.
double scatter(int thing, int what) {
  std::mt19937 random(static_cast<unsigned>(97 * thing + what));
  double sum = 0.0;
  for (int i = 0; i < 12; ++i) sum += static_cast<double>(random()) / 4294967296.0;
  return sum - 6.0;
}

TEST(Adaptation, StaysWhereItIsWhenNothingChanges) {
  Drive drive(referenced());
  drive.run(300, [](int thing, double) {
    return tree(kWidth_m + 0.01 * scatter(thing, 0),
                {0.05 * scatter(thing, 1), 0.05 * scatter(thing, 2), 0.2 * scatter(thing, 3)});
  });
  EXPECT_NEAR(drive.model().width_mean_m, kWidth_m, 0.005);  // half of the trees' scatter
  EXPECT_NEAR(drive.model().light.blue, 0.0, 0.025);
  EXPECT_NEAR(drive.model().light.red, 0.0, 0.025);
  EXPECT_NEAR(drive.model().light.green, 0.0, 0.1);
}

TEST(Adaptation, FollowsASlowDriftOfLightAndWidth) {
  Drive drive(referenced());
  const auto drifting = [](int thing, double t_s) {
    return tree(kWidth_m + 0.00003 * t_s,
                {-0.001 * t_s + 0.02 * scatter(thing, 1), 0.0007 * t_s, 0.002 * t_s});
  };
  drive.run(300, drifting);
  EXPECT_NEAR(drive.model().light.blue, -0.3, 0.04);
  EXPECT_NEAR(drive.model().light.red, 0.21, 0.03);
  EXPECT_NEAR(drive.model().light.green, 0.6, 0.06);
  EXPECT_NEAR(drive.model().width_mean_m, 0.129, 0.002);
  EXPECT_EQ(drive.count(AdaptationAction::kFreeze, AdaptationReason::kTwoPopulations), 0);
}

TEST(Adaptation, EveryChangeIsLoggedAndWithinTheRates) {
  const AdaptationConfig config = referenced();
  Drive drive(config);
  drive.run(20, [](int, double) { return tree(); });
  drive.run(100, [](int, double) { return tree(1.3 * kWidth_m, {0.25, 0.25, 0.8}); });
  ASSERT_GT(drive.steps().size(), 10u);
  AdaptedModel before{kWidth_m, {}};
  std::int64_t utime = 0;
  for (std::size_t i = 0; i < drive.steps().size(); ++i) {
    const AdaptationStep& step = drive.steps()[i];
    EXPECT_EQ(step.seq, static_cast<int>(i));
    EXPECT_GE(step.utime, utime);
    const double dt_s = 1e-6 * static_cast<double>(step.utime - utime) + 1e-9;
    EXPECT_LE(std::abs(step.model.width_mean_m - before.width_mean_m),
              config.width_rate_per_s * kWidth_m * dt_s);
    EXPECT_LE(std::abs(step.model.light.blue - before.light.blue), config.colour_rate_per_s * dt_s);
    EXPECT_LE(std::abs(step.model.light.red - before.light.red), config.colour_rate_per_s * dt_s);
    EXPECT_LE(std::abs(step.model.light.green - before.light.green),
              config.brightness_rate_per_s * dt_s);
    if (step.action != AdaptationAction::kStep) continue;
    before = step.model;
    utime = step.utime;
  }
  EXPECT_EQ(before.width_mean_m, drive.model().width_mean_m);
  EXPECT_EQ(before.light.blue, drive.model().light.blue);
  EXPECT_GT(before.light.blue, 0.1);
}

TEST(Adaptation, NeverGoesBeyondItsBounds) {
  AdaptationConfig config = referenced();
  Drive drive(config);
  drive.run(2000, [](int, double t_s) {
    return tree(kWidth_m * (1.0 + 0.0005 * t_s), {-0.0008 * t_s, 0.0008 * t_s, 0.002 * t_s});
  });
  EXPECT_DOUBLE_EQ(drive.model().width_mean_m, kWidth_m * (1.0 + config.width_limit));
  EXPECT_DOUBLE_EQ(drive.model().light.blue, -config.colour_limit);
  EXPECT_DOUBLE_EQ(drive.model().light.red, config.colour_limit);
  EXPECT_DOUBLE_EQ(drive.model().light.green, config.brightness_limit);
}

TEST(Adaptation, ARowOfPostsDoesNotDragTheModelAway) {
  // Three of ten things are posts as wide as trunks, of a grey that passes the colour gate now and
  // then: the laser takes them for trunks, the camera does not.
  Drive drive(referenced());
  drive.run(1000, [](int thing, double) {
    AdaptationObservation observation =
        tree(kWidth_m + 0.01 * scatter(thing, 0),
             {0.05 * scatter(thing, 1), 0.05 * scatter(thing, 2), 0.0});
    if (thing % 10 < 3) {
      observation = tree(1.2 * kWidth_m, {0.28, -0.2, 0.3});
      observation.roc_colour = 0.3;
      observation.roc_vision = 0.3;
    }
    return observation;
  });
  for (const auto& step : drive.steps()) {
    EXPECT_NEAR(step.model.width_mean_m, kWidth_m, 0.01);  // the trees' sigma
    EXPECT_NEAR(step.model.light.blue, 0.0, 0.05);
    EXPECT_NEAR(step.model.light.red, 0.0, 0.05);
  }
}

// Twice as many as the trunks, but each for two scans only: no model has collapsed.
TEST(Adaptation, WhatIsSeenBrieflySaysLittle) {
  Adaptation adaptation(referenced(), kWidth_m);
  for (int i = 0; i < 1200; ++i) {
    AdaptationObservation trunk = tree();
    trunk.x_m = 2.0 - 0.1 * (i % 20);
    trunk.y_m = 1.0;
    std::vector<AdaptationObservation> observations{trunk};
    if (i > 600 && i % 10 < 2) {  // one more twig of a hedge every second
      AdaptationObservation twig = tree();
      twig.roc_colour = twig.roc_vision = 0.0;
      twig.x_m = 2.0;
      twig.y_m = -3.0;
      observations.push_back(twig);
    }
    for (const AdaptationStep& step : adaptation.add(100'000 * (i + 1), observations)) {
      EXPECT_NE(step.action, AdaptationAction::kRollback) << i;
      EXPECT_NE(step.action, AdaptationAction::kReset) << i;
      EXPECT_NE(step.reason, AdaptationReason::kConfidenceCollapsed) << i;
    }
  }
}

TEST(Adaptation, AThingLookedAtForeverCountsOnce) {
  Drive drive(referenced());
  drive.run(30, [](int, double) { return tree(); });
  const AdaptedModel before = drive.model();
  // The robot stands before one post that fools both sensors.
  Adaptation standing(referenced(), kWidth_m);
  for (int i = 0; i < 3000; ++i) {
    AdaptationObservation post = tree(1.1 * kWidth_m, {0.2, 0.2, 0.2});
    post.x_m = 1.5;
    standing.add(100'000 * i, {post});
  }
  EXPECT_EQ(standing.model().width_mean_m, kWidth_m);
  EXPECT_EQ(standing.model().light.blue, 0.0);
  EXPECT_EQ(before.width_mean_m, kWidth_m);
}

TEST(Adaptation, TooFewTreesFreezeAndMoreResume) {
  Drive drive(referenced());
  drive.run(5, [](int, double) { return tree(1.1 * kWidth_m); });
  ASSERT_EQ(drive.steps().size(), 1u);
  EXPECT_EQ(drive.steps()[0].action, AdaptationAction::kFreeze);
  EXPECT_EQ(drive.steps()[0].reason, AdaptationReason::kTooFewTrees);
  EXPECT_EQ(drive.model().width_mean_m, kWidth_m);
  drive.run(20, [](int, double) { return tree(1.1 * kWidth_m); });
  EXPECT_EQ(drive.count(AdaptationAction::kResume, AdaptationReason::kNone), 1);
  EXPECT_GT(drive.model().width_mean_m, kWidth_m);
}

TEST(Adaptation, SensorsThatDisagreeFreeze) {
  Drive drive(referenced());
  drive.run(60, [](int thing, double) {
    AdaptationObservation observation = tree(1.1 * kWidth_m, {0.2, 0.0, 0.0});
    if (thing % 8 != 7) observation.roc_vision = 0.2;
    return observation;
  });
  EXPECT_EQ(drive.count(AdaptationAction::kFreeze, AdaptationReason::kSensorsDisagree), 1);
  EXPECT_EQ(drive.model().width_mean_m, kWidth_m);
  EXPECT_EQ(drive.model().light.blue, 0.0);
}

TEST(Adaptation, TwoPopulationsFreezeTheWidthOnly) {
  Drive drive(referenced());
  drive.run(100, [](int thing, double) {
    return tree((thing % 2 ? 0.9 : 1.3) * kWidth_m + 0.002 * scatter(thing, 0), {0.1, 0.0, 0.0});
  });
  EXPECT_GE(drive.count(AdaptationAction::kFreeze, AdaptationReason::kTwoPopulations), 1);
  EXPECT_EQ(drive.model().width_mean_m, kWidth_m);
  EXPECT_GT(drive.model().light.blue, 0.05);
}

TEST(Adaptation, GoesBackWhenConfidenceCollapses) {
  Drive drive(referenced());
  drive.run(60, [](int, double t_s) { return tree(kWidth_m, {-0.001 * t_s, 0.0, 0.0}); });
  const double good = drive.model().light.blue;
  ASSERT_LT(good, -0.02);
  // Something goes wrong: colour runs on while the camera confirms ever less.
  drive.run(40, [](int thing, double t_s) {
    AdaptationObservation observation = tree(kWidth_m, {-0.06 - 0.006 * (t_s - 60.0), 0.0, 0.0});
    if (thing % 10 >= 2) observation.roc_vision = 0.3;
    return observation;
  });
  ASSERT_GE(drive.count(AdaptationAction::kRollback, AdaptationReason::kConfidenceCollapsed), 1);
  for (const auto& step : drive.steps()) {
    if (step.action != AdaptationAction::kRollback) continue;
    EXPECT_NEAR(step.model.light.blue, good, 0.06);
    break;
  }
  // And when that does not help, to the calibration, exactly.
  drive.run(200, [](int, double) {
    AdaptationObservation observation = tree(kWidth_m, {-0.05, 0.0, 0.0});
    observation.roc_vision = 0.1;
    return observation;
  });
  EXPECT_EQ(drive.count(AdaptationAction::kReset, AdaptationReason::kConfidenceCollapsed), 1);
  EXPECT_EQ(drive.model().width_mean_m, kWidth_m);
  EXPECT_EQ(drive.model().light.blue, 0.0);
  EXPECT_EQ(drive.model().light.green, 0.0);
}

TEST(Adaptation, WithoutReferencesTheFirstTreesAreInTheLightOfTheCalibration) {
  AdaptationConfig config;
  config.enabled = true;
  Drive drive(config);
  const auto offset = [](double blue) {
    return [blue](int, double) { return tree(kWidth_m, {blue, 0.0, 0.0}); };
  };
  drive.run(40, offset(0.4));
  EXPECT_EQ(drive.model().light.blue, 0.0);
  drive.run(100, offset(0.3));
  EXPECT_NEAR(drive.model().light.blue, -0.1, 1e-9);
}

TEST(Adaptation, AScanOfThePastTeachesNothing) {
  Adaptation adaptation(referenced(), kWidth_m);
  EXPECT_TRUE(adaptation.add(1'000'000, {tree()}).empty());
  EXPECT_EQ(adaptation.add(2'500'000, {tree()}).size(), 1u);  // frozen: too few trees
  EXPECT_TRUE(adaptation.add(2'500'000, {tree()}).empty());
  EXPECT_TRUE(adaptation.add(1'000'000, {tree()}).empty());
}

TEST(Adaptation, UndoingLightIsItsInverse) {
  const vision::ChannelGains gains = light_correction_gains({0.2, -0.1, 0.5});
  EXPECT_NEAR(gains.green, std::exp(-0.5), 1e-12);
  EXPECT_NEAR(gains.blue, std::exp(-0.7), 1e-12);
  EXPECT_NEAR(gains.red, std::exp(-0.4), 1e-12);
  EXPECT_TRUE(light_correction_gains({}).none());
}

}  // namespace
}  // namespace orchard::detection
