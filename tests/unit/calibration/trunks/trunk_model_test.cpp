// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/trunk_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <string>

#include "calibration/trunks/hue_interval.hpp"

namespace orchard::calibration {
namespace {

/// A normal number from whole random bits, so that every library gives the same.
double normal(std::mt19937_64& random) {
  const double u = (static_cast<double>(random() >> 11) + 0.5) / 9007199254740992.0;
  const double v = static_cast<double>(random() >> 11) / 9007199254740992.0;
  return std::sqrt(-2.0 * std::log(u)) * std::cos(6.283185307179586 * v);
}

vision::HueHistogram hues_around(double hue_deg, double sd_deg, std::mt19937_64& random) {
  vision::HueHistogram hues;
  for (int i = 0; i < 200; ++i) {
    const long hue = std::lround((hue_deg + sd_deg * normal(random)) / vision::kHueStep_deg);
    ++hues.counts[static_cast<std::size_t>((hue + 4 * vision::kNumHues) % vision::kNumHues)];
  }
  hues.num_coloured = hues.num_pixels = 200;
  return hues;
}

struct Kind {
  int count;
  double width_m, width_sd_m, hue_deg;
};

/// `observations_each` looks at things of several kinds that stand 2 m apart.
std::vector<TrunkObservation> observations_at(const std::vector<Kind>& kinds, int observations_each,
                                              unsigned seed) {
  std::mt19937_64 random(seed);
  std::vector<TrunkObservation> observations;
  for (int i = 0; i < observations_each; ++i) {
    double x_m = 0.0;
    for (const Kind& kind : kinds) {
      for (int k = 0; k < kind.count; ++k, x_m += 2.0) {
        TrunkObservation observation;
        observation.utime = i * 100'000;
        observation.x_m = x_m + 0.02 * normal(random);
        observation.y_m = 0.02 * normal(random);
        observation.in_map = true;
        observation.width_m = kind.width_m + kind.width_sd_m * normal(random);
        observation.hues = hues_around(kind.hue_deg, 3.0, random);
        observations.push_back(observation);
      }
    }
  }
  return observations;
}

TEST(TrunkModel, MeasuresTheDominantKindAndLeavesTheOthersOut) {
  const auto observations = observations_at(
      {{24, 0.09, 0.008, 30.0}, {6, 0.17, 0.008, 30.0}, {6, 0.09, 0.008, 210.0}}, 8, 1);
  const TrunkModel model = estimate_trunk_model(observations, {});
  EXPECT_EQ(model.num_trunks, 24);
  EXPECT_EQ(model.objects.size(), 36u);
  EXPECT_NEAR(model.width_mean_m, 0.09, 0.0015);
  EXPECT_NEAR(model.width_sd_m, 0.008, 0.001);
  EXPECT_LT(model.hue_min_deg, 24.0);
  EXPECT_GT(model.hue_max_deg, 36.0);
  EXPECT_GT(model.hue_min_deg, 10.0);
  EXPECT_LT(model.hue_max_deg, 50.0);
  EXPECT_TRUE(model.warnings.empty());
}

TEST(TrunkModel, ThePapersTrees) {  // section 6.2: 230.15 mm, sd 20.45 mm
  const TrunkModel model =
      estimate_trunk_model(observations_at({{20, 0.23015, 0.02045, 31.0}}, 30, 2), {});
  EXPECT_NEAR(model.width_mean_m, 0.23015, 0.003);
  EXPECT_NEAR(model.width_sd_m, 0.02045, 0.003);
}

TEST(TrunkModel, PaleBarkInBluishLightIsOneKindWhateverItsHue) {
  // Grey-brown bark in sun and, every other trunk, in open shade: hues 150 degrees apart, colours
  // not.
  auto observations = observations_at(
      {{10, 0.12, 0.008, 50.0}, {10, 0.12, 0.008, 200.0}, {6, 0.12, 0.008, 200.0}}, 8, 6);
  for (TrunkObservation& observation : observations) {
    const bool is_painted = observation.x_m > 39.0;
    const bool in_shade = observation.x_m > 19.0;
    observation.light = is_painted ? vision::WindowLight{0.9, -0.6, 4.0}
                        : in_shade ? vision::WindowLight{0.05, -0.05, 3.5}
                                   : vision::WindowLight{-0.15, 0.05, 4.0};
  }
  EXPECT_EQ(estimate_trunk_model(observations, {}).num_trunks, 20);
}

TEST(TrunkModel, PartsOfABushAreNoTrunks) {
  // Six bushes of five stems of a trunk's width each, and twelve trunks that stand alone.
  auto observations = observations_at({{12, 0.12, 0.008, 30.0}, {30, 0.13, 0.008, 30.0}}, 8, 7);
  for (TrunkObservation& observation : observations) {
    if (observation.x_m < 23.0) continue;
    const long k = std::lround(0.5 * observation.x_m) - 12;  // number of the part
    observation.x_m += 3.0 + 4.0 * static_cast<double>(k / 5) - 1.6 * static_cast<double>(k);
  }
  const TrunkModel model = estimate_trunk_model(observations, {});
  EXPECT_EQ(model.num_trunks, 12);
  EXPECT_NEAR(model.width_mean_m, 0.12, 0.002);
}

TEST(TrunkModel, OutliersDoNotMoveIt) {
  auto observations = observations_at({{20, 0.09, 0.006, 30.0}}, 10, 4);
  for (std::size_t i = 0; i < observations.size(); i += 12) observations[i].width_m = 0.02;
  const TrunkModel model = estimate_trunk_model(observations, {});
  EXPECT_NEAR(model.width_mean_m, 0.09, 0.0015);
  EXPECT_NEAR(model.width_sd_m, 0.006, 0.001);
}

TEST(TrunkModel, WarnsOfFewTrunks) {
  const TrunkModel model =
      estimate_trunk_model(observations_at({{5, 0.09, 0.006, 30.0}}, 8, 5), {});
  EXPECT_EQ(model.num_trunks, 5);
  ASSERT_EQ(model.warnings.size(), 1u);
  EXPECT_NE(model.warnings[0].find("only 5 trunks"), std::string::npos);
}

TEST(TrunkModel, RefusesToLearnFromNothing) {
  EXPECT_THROW(estimate_trunk_model({}, {}), std::runtime_error);
  EXPECT_THROW(estimate_trunk_model(observations_at({{5, 0.09, 0.006, 30.0}}, 2, 5), {}),
               std::runtime_error);
}

TEST(TrunkModel, WithoutPosesThingsAreFollowedFromObservationToObservation) {
  std::mt19937_64 random(6);
  std::vector<TrunkObservation> observations;
  for (int i = 0; i < 60; ++i) {  // 0.1 m per observation past trunks 2 m apart
    for (int k = 0; k < 8; ++k) {
      const double x_m = 2.0 * k - 0.1 * i;
      if (x_m < 0.0 || x_m > 3.0) continue;
      TrunkObservation observation;
      observation.utime = i * 100'000;
      observation.x_m = x_m;
      observation.y_m = 1.0;
      observation.width_m = 0.09 + 0.004 * normal(random);
      observations.push_back(observation);
    }
  }
  const TrunkModel model = estimate_trunk_model(observations, {});
  EXPECT_EQ(model.num_trunks, 4);  // at 2, 4, 6 and 8 m; the one at 0 m was seen once
  EXPECT_FALSE(model.has_hue);
}

TEST(TrunkModel, ThingsOfDifferentLogsAreDifferent) {
  auto observations = observations_at({{6, 0.09, 0.006, 30.0}}, 5, 7);
  auto second = observations;
  for (auto& observation : second) observation.log = 1;
  observations.insert(observations.end(), second.begin(), second.end());
  EXPECT_EQ(estimate_trunk_model(observations, {}).num_trunks, 12);
}

TEST(HueInterval, IsCircular) {
  std::mt19937_64 random(8);
  const HueInterval interval = hue_interval(hues_around(0.0, 5.0, random), 0.01, 4.0);
  EXPECT_GT(interval.min_deg, 330.0);
  EXPECT_LT(interval.max_deg, 30.0);
  EXPECT_LT(interval.width_deg, 50.0);
  EXPECT_TRUE(vision::hue_in_range(0.0, interval.min_deg, interval.max_deg));
  EXPECT_FALSE(vision::hue_in_range(180.0, interval.min_deg, interval.max_deg));
}

TEST(HueInterval, LeavesOutStrayPixels) {
  std::mt19937_64 random(9);
  vision::HueHistogram hues = hues_around(40.0, 4.0, random);
  hues.counts[100] += 1;
  hues.num_coloured += 1;
  EXPECT_LT(hue_interval(hues, 0.01, 2.0).width_deg, 40.0);
  EXPECT_GT(hue_interval(hues, 0.0, 2.0).width_deg, 150.0);
}

TEST(HueInterval, AllHuesMakeAFullCircle) {
  vision::HueHistogram hues;
  hues.counts.fill(1);
  hues.num_coloured = vision::kNumHues;
  const HueInterval interval = hue_interval(hues, 0.0, 4.0);
  EXPECT_EQ(interval.width_deg, 360.0);
  EXPECT_TRUE(vision::hue_in_range(123.0, interval.min_deg, interval.max_deg));
  EXPECT_THROW(hue_interval({}, 0.01, 2.0), std::invalid_argument);
}

bool warns_of(const TrunkModel& model, const std::string& words) {
  for (const std::string& warning : model.warnings) {
    if (warning.find(words) != std::string::npos) return true;
  }
  return false;
}

TEST(TrunkModel, PicksByNumberAreTheTrunks) {
  const auto observations =
      observations_at({{24, 0.09, 0.004, 30.0}, {6, 0.17, 0.004, 210.0}}, 8, 5);
  TrunkModelOptions options;
  options.wanted_trunks = 5;
  options.picked = {25, 26, 27, 28, 30};
  const TrunkModel model = estimate_trunk_model(observations, options);
  EXPECT_EQ(model.num_trunks, 5);
  EXPECT_NEAR(model.width_mean_m, 0.17, 0.003);
  EXPECT_FALSE(model.objects[28].is_trunk);
  options.picked = {31};
  EXPECT_THROW(estimate_trunk_model(observations, options), std::runtime_error);
}

TEST(TrunkModel, PicksByPlaceAreTheTrunksThatStandThere) {
  const auto observations = observations_at({{4, 0.09, 0.004, 30.0}, {3, 0.17, 0.004, 30.0}}, 8, 6);
  TrunkModelOptions options;
  options.picked_trunks = {{7, 8.05, 0.0}, {9, 12.0, 0.1}};
  const TrunkModel model = estimate_trunk_model(observations, options);
  EXPECT_EQ(model.num_trunks, 2);
  EXPECT_NEAR(model.width_mean_m, 0.17, 0.004);
  options.picked_trunks.push_back({11, 40.0, 0.0});
  try {
    estimate_trunk_model(observations, options);
    FAIL() << "a place where nothing stands";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("landmark 11"), std::string::npos) << error.what();
  }
}

TEST(TrunkModel, WarnsWhenTwoPopulationsDoNotSeparate) {
  // Clear of each other in hue: nothing to say.
  const auto apart = observations_at({{24, 0.12, 0.004, 30.0}, {8, 0.12, 0.004, 200.0}}, 8, 7);
  EXPECT_TRUE(estimate_trunk_model(apart, {}).warnings.empty());
  // Wide scatter of both: the second group begins where the first ends.
  std::vector<Kind> kinds;
  for (int i = 0; i < 40; ++i) kinds.push_back({1, 0.10 + 0.002 * i, 0.001, 30.0});
  EXPECT_TRUE(
      warns_of(estimate_trunk_model(observations_at(kinds, 8, 8), {}), "cannot be separated"));
}

TEST(TrunkModel, WarnsWhenTheOthersAreAsMany) {
  const auto observations =
      observations_at({{24, 0.12, 0.004, 30.0}, {20, 0.12, 0.004, 200.0}}, 8, 9);
  EXPECT_TRUE(warns_of(estimate_trunk_model(observations, {}), "about as many"));
}

TEST(TrunkModel, WarnsOfAMixedOrchard) {
  const auto mixed = observations_at({{12, 0.10, 0.002, 30.0}, {12, 0.125, 0.002, 30.0}}, 8, 10);
  EXPECT_TRUE(warns_of(estimate_trunk_model(mixed, {}), "two kinds"));
}

}  // namespace
}  // namespace orchard::calibration
