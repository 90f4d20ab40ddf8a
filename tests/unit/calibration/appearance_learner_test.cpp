// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/appearance_learner.hpp"

#include <gtest/gtest.h>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "geometry/statistics.hpp"
#include "vision/appearance.hpp"

namespace orchard::calibration {
namespace {

/// Seeded numbers, roughly normal: the sum of twelve uniform ones less six.
class Noise {
 public:
  explicit Noise(unsigned seed) : engine_(seed) {}
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }
  double operator()() {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum;
  }

 private:
  std::mt19937_64 engine_;
};

/// Windows whose truth follows a known logistic law of two features; all others are noise. Each
/// group is off by a little of its own.
std::vector<AppearanceSample> samples_of_law(unsigned seed, int num_groups, int per_group,
                                             double steepness) {
  Noise noise(seed);
  std::vector<AppearanceSample> samples;
  for (int group = 0; group < num_groups; ++group) {
    const double own = 0.2 * noise();
    for (int i = 0; i < per_group; ++i) {
      AppearanceSample sample;
      sample.group = group;
      for (double& value : sample.features) value = 3.0 + 2.0 * noise();
      const double log_odds =
          steepness * (0.5 * (sample.features[4] - 3.0) - 0.25 * (sample.features[9] - 3.0) + own);
      sample.is_trunk = noise.uniform() < 1.0 / (1.0 + std::exp(-log_odds));
      samples.push_back(sample);
    }
  }
  return samples;
}

double area_on(const std::vector<AppearanceSample>& samples, const vision::AppearanceConfig& c) {
  std::vector<double> trunk, other;
  for (const AppearanceSample& s : samples) {
    (s.is_trunk ? trunk : other).push_back(vision::appearance_log_odds(s.features, c));
  }
  return geometry::roc_area(trunk, other);
}

TEST(RocArea, IsTheFractionOfPairsInOrder) {
  EXPECT_DOUBLE_EQ(geometry::roc_area({3, 4}, {1, 2}), 1.0);
  EXPECT_DOUBLE_EQ(geometry::roc_area({1, 2}, {3, 4}), 0.0);
  EXPECT_DOUBLE_EQ(geometry::roc_area({1, 3}, {2, 4}), 0.25);
  EXPECT_DOUBLE_EQ(geometry::roc_area({1, 1}, {1, 1, 1}), 0.5);
  EXPECT_DOUBLE_EQ(geometry::roc_area({1, 2}, {1}), 0.75);
  EXPECT_DOUBLE_EQ(geometry::roc_area({}, {1}), 0.5);
}

// Trunks in the middle of a feature, other things at both ends: no plane parts them.
TEST(AppearanceLearner, TakesSquaresWhereTheyAreBetterAndOnlyThere) {
  auto samples = samples_of_law(5, 12, 100, 0.0);
  for (AppearanceSample& s : samples) s.is_trunk = std::abs(s.features[4] - 3.0) < 1.4;
  const AppearanceFit in_between = learn_appearance(samples);
  ASSERT_EQ(in_between.config.squares.size(), vision::kNumAppearanceFeatures);
  EXPECT_LT(in_between.config.squares[4], 0.0);
  EXPECT_GT(in_between.area, 0.95);
  EXPECT_TRUE(learn_appearance(samples_of_law(1, 12, 100, 3.0)).config.squares.empty());
}

TEST(AppearanceLearner, FindsTheLawThatMadeTheWindows) {
  const auto samples = samples_of_law(1, 12, 200, 3.0);
  const AppearanceFit fit = learn_appearance(samples);
  // Weights are per standard deviation (2): the law's 0.5 and -0.25 stand two to one.
  const auto& w = fit.config.weights;
  EXPECT_NEAR(w[4] / w[9], -2.0, 0.25);
  for (std::size_t i = 0; i < w.size(); ++i) {
    if (i != 4 && i != 9) {
      EXPECT_LT(std::abs(w[i]), 0.12 * w[4]) << i;
    }
    EXPECT_NEAR(fit.config.mean[i], 3.0, 0.15) << i;
    EXPECT_NEAR(fit.config.scale[i], 2.0, 0.1) << i;
  }
  EXPECT_EQ(fit.num_groups, 12);
  EXPECT_EQ(fit.num_trunk + fit.num_other, 2400);
  // What it says of groups left out is what it does on groups it never saw.
  EXPECT_NEAR(fit.area, area_on(samples_of_law(2, 50, 100, 3.0), fit.config), 0.02);
}

TEST(AppearanceLearner, ItsConfidenceMeansWhatItSays) {
  const AppearanceFit fit = learn_appearance(samples_of_law(3, 12, 300, 2.0));
  std::array<double, 5> said{}, true_fraction{}, count{};
  for (const AppearanceSample& s : samples_of_law(4, 60, 200, 2.0)) {
    const double p = vision::appearance_confidence(s.features, fit.config);
    const auto bin = std::min<std::size_t>(4, static_cast<std::size_t>(5.0 * p));
    said[bin] += p;
    true_fraction[bin] += s.is_trunk ? 1.0 : 0.0;
    count[bin] += 1.0;
  }
  for (std::size_t bin = 0; bin < 5; ++bin) {
    ASSERT_GT(count[bin], 200.0);
    EXPECT_NEAR(said[bin] / count[bin], true_fraction[bin] / count[bin], 0.05) << bin;
  }
}

TEST(AppearanceLearner, MoreOfOneClassMovesNoBias) {
  auto samples = samples_of_law(6, 8, 200, 3.0);
  const AppearanceFit balanced = learn_appearance(samples);
  const std::size_t n = samples.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (int copy = 0; copy < 4 && !samples[i].is_trunk; ++copy) samples.push_back(samples[i]);
  }
  const AppearanceFit skewed = learn_appearance(samples);
  vision::AppearanceFeatures average{};
  average.fill(3.0);
  EXPECT_NEAR(vision::appearance_confidence(average, skewed.config),
              vision::appearance_confidence(average, balanced.config), 0.05);
}

TEST(AppearanceLearner, SeparableWindowsGiveFiniteWeights) {
  std::vector<AppearanceSample> samples;
  for (int i = 0; i < 60; ++i) {
    AppearanceSample sample;
    sample.is_trunk = i % 2 == 0;
    sample.group = i;  // every thing is of one class: as when they come from a drive
    sample.features[0] = (sample.is_trunk ? 1.0 : -1.0) + 0.01 * (i % 7);
    samples.push_back(sample);
  }
  const AppearanceFit fit = learn_appearance(samples);
  EXPECT_DOUBLE_EQ(fit.area, 1.0);
  for (const double weight : fit.config.weights) EXPECT_TRUE(std::isfinite(weight));
  for (const AppearanceSample& s : samples) {
    EXPECT_EQ(vision::appearance_confidence(s.features, fit.config) > 0.5, s.is_trunk);
  }
  EXPECT_TRUE(vision::fits_features(fit.config));
}

TEST(AppearanceLearner, OneGroupIsLearntWithoutACheck) {
  const AppearanceFit fit = learn_appearance(samples_of_law(7, 1, 400, 3.0));
  EXPECT_DOUBLE_EQ(fit.area, 0.5);
  EXPECT_GT(area_on(samples_of_law(8, 10, 100, 3.0), fit.config), 0.8);
}

TEST(AppearanceLearner, RefusesWhatTeachesNothing) {
  EXPECT_THROW(learn_appearance({}), std::runtime_error);
  auto samples = samples_of_law(9, 3, 100, 3.0);
  for (AppearanceSample& sample : samples) sample.is_trunk = true;
  EXPECT_THROW(learn_appearance(samples), std::runtime_error);
  samples = samples_of_law(9, 3, 100, 3.0);
  samples[50].features[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(learn_appearance(samples), std::runtime_error);
}

}  // namespace

}  // namespace orchard::calibration
