// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/trunk_model.hpp"

#include <gtest/gtest.h>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>

#include "calibration/trunks/trunk_observation.hpp"
#include "calibration/trunks/trunk_selection.hpp"
#include "calibration/trunks/width_by_range.hpp"
#include "unit/detection/tube_rig.hpp"

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

using test::blue_tube;
using test::brown_tube;

TEST(TrunkObservation, ObservationsAtEverythingWhateverItsWidthAndColour) {
  const auto rig = test::tube_rig();
  const std::vector<test::Tube> tubes{brown_tube(1.5, 0.5), brown_tube(1.5, 0.0, 0.17),
                                      blue_tube(1.5, -0.5)};
  const auto image = test::picture_of_tubes(tubes, rig);
  const auto observations = observe_trunks(test::scan_of(tubes), &image, rig, 4);
  ASSERT_EQ(observations.size(), 3u);  // from right to left
  EXPECT_NEAR(vision::dominant_hue_deg(observations[0].hues, 36), 215.0, 6.0);
  EXPECT_NEAR(observations[1].width_m, 0.17, 0.01);
  EXPECT_NEAR(vision::dominant_hue_deg(observations[2].hues, 36), 27.0, 6.0);
  EXPECT_NEAR(observations[2].x_m, 1.5, 0.015);
  EXPECT_NEAR(observations[2].y_m, 0.5, 0.015);
  EXPECT_FALSE(observations[2].in_map);
}

TEST(TrunkObservation, LeavesOutWhatIsHiddenThinOrOutOfView) {
  const auto rig = test::tube_rig();
  const std::vector<test::Tube> tubes{brown_tube(1.0, 0.0), brown_tube(2.0, 0.11),
                                      brown_tube(0.0, 1.5), brown_tube(3.0, -0.8, 0.03)};
  const auto image = test::picture_of_tubes(tubes, rig);
  EXPECT_EQ(observe_trunks(test::scan_of(tubes), &image, rig, 4).size(), 1u);
}

TEST(TrunkObservation, ARigWithACameraLearnsNothingWithoutAPicture) {
  const std::vector<test::Tube> tubes{brown_tube(1.5, 0.5)};
  EXPECT_TRUE(observe_trunks(test::scan_of(tubes), nullptr, test::tube_rig(), 4).empty());
  const auto observations =
      observe_trunks(test::scan_of(tubes), nullptr, test::tube_rig({}, false), 4);
  ASSERT_EQ(observations.size(), 1u);
  EXPECT_EQ(observations[0].hues.num_pixels, 0);
}

enum class Sort { kTrunk, kLateTrunk, kPost, kLatePost, kCrate };

constexpr double kTypical_m = 0.12;

/// A window of bark is bright in one feature, any other is dark there; all others are noise.
WindowObservation window_of(bool is_bark, std::mt19937_64& random) {
  const auto noise = [&] { return static_cast<double>(random() >> 11) * 0x1.0p-53 - 0.5; };
  WindowObservation window;
  for (double& feature : window.features) feature = noise();
  window.features[0] += is_bark ? 1.0 : -1.0;
  return window;
}

/// Things 2 m apart; the late ones are observed in three scans of twelve.
std::vector<TrunkObservation> drive_past(const std::vector<Sort>& things) {
  std::mt19937_64 random(7);
  std::vector<TrunkObservation> observations;
  for (int scan = 0; scan < 12; ++scan) {
    for (std::size_t i = 0; i < things.size(); ++i) {
      const Sort sort = things[i];
      if ((sort == Sort::kLateTrunk || sort == Sort::kLatePost) && scan < 9) continue;
      TrunkObservation observation;
      observation.utime = scan * 100'000;
      observation.x_m = 2.0 * static_cast<double>(i) + 0.01 * (scan % 3);
      observation.in_map = true;
      observation.width_m = (sort == Sort::kCrate ? 3.0 : 1.0) * kTypical_m;
      observation.hues.counts[60] = observation.hues.num_coloured = 100;
      observation.hues.num_pixels = 100;
      const bool is_bark = sort == Sort::kTrunk || sort == Sort::kLateTrunk;
      observation.on.push_back(window_of(is_bark, random));
      observation.beside.push_back(window_of(false, random));
      observations.push_back(observation);
    }
  }
  return observations;
}

/// Checks the trunks by the sort of what stands there.
template <class IsTrunk>
void expect_trunks(const TrunkModel& model, const std::vector<Sort>& things,
                   const IsTrunk& is_trunk) {
  ASSERT_EQ(model.objects.size(), things.size());
  for (std::size_t i = 0; i < things.size(); ++i) {
    EXPECT_EQ(model.objects[i].is_trunk, is_trunk(things[i])) << i;
  }
}

TEST(TrunkSelection, LateTrunksAreAddedByTheirAppearanceAndPostsAreNot) {
  std::vector<Sort> things(16, Sort::kTrunk);
  things.insert(things.end(), 4, Sort::kCrate);
  things.insert(things.end(), 3, Sort::kLateTrunk);
  things.insert(things.end(), 3, Sort::kLatePost);
  const auto observations = drive_past(things);
  const TrunkModel first = estimate_trunk_model(observations, {});
  EXPECT_EQ(first.num_trunks, 16);
  expect_trunks(select_trunks(observations, first, {}), things,
                [](Sort sort) { return sort == Sort::kTrunk || sort == Sort::kLateTrunk; });
  // What a person picked stays as it is.
  TrunkModelOptions picked;
  for (const int i : {0, 1, 2, 3}) {
    picked.picked_trunks.push_back({i + 1, first.objects[i].x_m, first.objects[i].y_m});
  }
  const TrunkModel by_hand = estimate_trunk_model(observations, picked);
  EXPECT_EQ(select_trunks(observations, by_hand, picked).num_trunks, 4);
}

// A post as wide as the trunks and as often seen is one of them by its width; it looks like the
// crates. Without the camera nothing tells it from a trunk.
TEST(TrunkSelection, PostsAsWideAsTrunksAreLeftOutByTheirAppearance) {
  std::vector<Sort> things(16, Sort::kTrunk);
  things.insert(things.end(), 2, Sort::kPost);
  things.insert(things.end(), 6, Sort::kCrate);
  const auto observations = drive_past(things);
  const TrunkModel first = estimate_trunk_model(observations, {});
  EXPECT_EQ(first.num_trunks, 18);
  expect_trunks(select_trunks(observations, first, {}), things,
                [](Sort sort) { return sort == Sort::kTrunk; });
}

// Bark that looks like everything else says nothing: the choice by width stays.
TEST(TrunkSelection, LooksThatSeparateNothingChangeNothing) {
  std::vector<Sort> things(8, Sort::kPost);
  things.insert(things.end(), 6, Sort::kCrate);
  const auto observations = drive_past(things);
  const TrunkModel first = estimate_trunk_model(observations, {});
  expect_trunks(select_trunks(observations, first, {}), things,
                [](Sort sort) { return sort == Sort::kPost; });
}

constexpr double kStep_rad = 0.00436;

/// Looks whose scatter follows the law with sd_m and growth, from 1 m to `far_m`.
std::vector<WidthObservation> observations_with(double sd_m, double growth, double far_m, int n) {
  std::mt19937_64 random(11);
  std::vector<WidthObservation> observations;
  for (int i = 0; i < n; ++i) {
    const double range_m = 1.0 + (far_m - 1.0) * i / n;
    const double sd = std::hypot(sd_m, growth * range_m * kStep_rad);
    observations.push_back({range_m, kStep_rad, 0.12 + sd * normal(random)});
  }
  return observations;
}

TEST(WidthByRange, FindsTheLawThatScatterFollows) {
  const WidthByRange width = width_by_range(observations_with(0.010, 0.8, 6.0, 3000));
  ASSERT_TRUE(width.has_growth);
  EXPECT_NEAR(width.sd_m, 0.010, 0.001);
  EXPECT_NEAR(width.sd_per_beam_step, 0.8, 0.08);
  ASSERT_EQ(width.bins.size(), 6u);
  int num_observations = 0;
  for (const WidthBin& bin : width.bins) {
    num_observations += bin.num_observations;
    const double middle_m = 0.5 * (bin.range_min_m + bin.range_max_m);
    EXPECT_NEAR(bin.mean_m, 0.12, 0.002);
    EXPECT_NEAR(bin.sd_m, std::hypot(0.010, 0.8 * middle_m * kStep_rad), 0.0015);
  }
  EXPECT_EQ(num_observations, 3000);
}

// A trunk that was not among the examples: its widths scatter as much as is said, however few
// trunks said so. The trunks scatter by 15 mm, the scanner's beams by 0.8 steps.
TEST(WidthByRange, FewTrunksTellWhatAnotherOneScatters) {
  constexpr int kSeeds = 2000, kTrunks = 6, kObservations = 20;
  double z2 = 0.0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    std::mt19937_64 random(static_cast<unsigned>(seed));
    std::vector<WidthObservation> observations;
    double mean_m = 0.0;
    const auto observe = [&](double trunk_m, int i) {
      const double range_m = 1.0 + 5.0 * i / kObservations;
      return WidthObservation{range_m, kStep_rad,
                              trunk_m + 0.8 * range_m * kStep_rad * normal(random)};
    };
    for (int trunk = 0; trunk < kTrunks; ++trunk) {
      const double trunk_m = 0.12 + 0.015 * normal(random);
      for (int i = 0; i < kObservations; ++i) {
        observations.push_back(observe(trunk_m, i));
        observations.back().trunk = trunk;
        mean_m += observations.back().width_m / (kTrunks * kObservations);
      }
    }
    const WidthByRange width = width_by_range(observations);
    const WidthObservation other = observe(0.12 + 0.015 * normal(random), seed % kObservations);
    const double off_m = other.width_m - mean_m;
    z2 += off_m * off_m /
          (width.sd_m * width.sd_m +
           std::pow(width.sd_per_beam_step * other.range_m * kStep_rad, 2.0)) /
          kSeeds;
  }
  EXPECT_NEAR(z2, 1.0, 0.2);
}

TEST(WidthByRange, NeitherPartIsEverNegative) {
  EXPECT_EQ(width_by_range(observations_with(0.0, 0.8, 6.0, 600)).has_growth, true);
  EXPECT_LT(width_by_range(observations_with(0.0, 0.8, 6.0, 600)).sd_m, 0.003);
  const WidthByRange flat = width_by_range(observations_with(0.010, 0.0, 6.0, 600));
  EXPECT_NEAR(flat.sd_m, 0.010, 0.001);
  EXPECT_LT(flat.sd_per_beam_step, 0.25);
  // Scatter that falls with range is no growth.
  std::vector<WidthObservation> falling = observations_with(0.010, 0.0, 6.0, 600);
  for (WidthObservation& observation : falling)
    observation.width_m = 0.12 + (observation.width_m - 0.12) / observation.range_m;
  EXPECT_EQ(width_by_range(falling).sd_per_beam_step, 0.0);
}

TEST(WidthByRange, OneRangeTellsNothingOfGrowth) {
  const WidthByRange width = width_by_range(observations_with(0.010, 0.8, 1.2, 600));
  EXPECT_FALSE(width.has_growth);
  EXPECT_NEAR(width.sd_m, 0.010, 0.001);
  EXPECT_FALSE(width_by_range(observations_with(0.010, 0.8, 6.0, 20)).has_growth);
  EXPECT_TRUE(width_by_range({}).bins.empty());
}

/// Counts of beams, each at a phase of its own, of trunks that a diverging beam makes wider; those
/// of fewer than `min_beams` were never handed over.
std::vector<SpotWidth> divergent_widths(double divergence_rad, int min_beams, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<SpotWidth> observations;
  for (int thing = 0; thing < 20; ++thing) {
    const double width_m = 0.10 + 0.002 * thing;
    for (int i = 0; i < 60; ++i) {
      const double range_m = 1.0 + 0.1 * i, beam_m = range_m * kStep_rad;
      const double phase = static_cast<double>(random() >> 11) * 0x1p-53;
      const double beams = std::floor((width_m + divergence_rad * range_m) / beam_m + phase);
      if (beams < min_beams) continue;
      observations.push_back({thing, range_m, kStep_rad, beams * beam_m});
    }
  }
  return observations;
}

TEST(SpotDivergence, IsTheDivergenceWithinItsStandardError) {
  for (const double divergence_rad : {0.0, 0.002, 0.006}) {
    double squares = 0.0;
    constexpr int kSeeds = 40;
    for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
      const auto growth = fit_spot_divergence(divergent_widths(divergence_rad, 4, seed), 4);
      ASSERT_TRUE(growth);
      EXPECT_LT(growth->se_rad, 0.001);
      squares += std::pow((growth->divergence_rad - divergence_rad) / growth->se_rad, 2) / kSeeds;
      EXPECT_EQ(growth->significant(), std::abs(growth->divergence_rad) > 3.0 * growth->se_rad);
      EXPECT_TRUE(growth->significant() || divergence_rad < 0.006);
    }
    EXPECT_LT(squares, 2.5) << divergence_rad;
  }
}

TEST(SpotDivergence, NeedsSeveralTrunksAtSeveralRanges) {
  EXPECT_FALSE(fit_spot_divergence({}, 4));
  EXPECT_FALSE(fit_spot_divergence({{0, 1.0, kStep_rad, 0.1}, {0, 2.0, kStep_rad, 0.1}}, 4));
  std::vector<SpotWidth> alike;
  for (int i = 0; i < 30; ++i) alike.push_back({i % 10, 2.0, kStep_rad, 0.1});
  EXPECT_FALSE(fit_spot_divergence(alike, 4));
}

}  // namespace

}  // namespace orchard::calibration
