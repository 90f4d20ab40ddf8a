// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/trunk_selection.hpp"

#include <gtest/gtest.h>

#include <random>

namespace orchard::calibration {
namespace {

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
  picked.picked = {1, 2, 3, 4};
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

}  // namespace
}  // namespace orchard::calibration
