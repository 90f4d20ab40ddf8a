// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/landmark_record.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace orchard::mapping {
namespace {

using detection::Label;

struct Sample {
  Eigen::Vector2d p_map;
  double roc = 0.0;
};

/// Observations of a tree far from the map's origin, spread over some centimetres.
std::vector<Sample> samples(std::uint64_t seed, int n) {
  std::mt19937_64 bits(seed);
  const auto uniform = [&bits] { return static_cast<double>(bits() >> 11) * 0x1p-53; };
  std::vector<Sample> all;
  for (int k = 0; k < n; ++k) {
    const double x_m = 812.0 + 0.06 * uniform();
    const double y_m = -455.0 + 0.5 * (x_m - 812.0) + 0.03 * uniform();
    all.push_back({{x_m, y_m}, uniform()});
  }
  return all;
}

/// An observation of 10 mm at something that moves on in base by more than a beam each time.
detection::Detection width_observation(double width_m, double along_m = 0.0) {
  detection::Detection d;
  d.width_m = width_m;
  d.width_sd_m = 0.01;
  d.centre_x_m = along_m;
  return d;
}

LandmarkRecord record_of(const std::vector<Sample>& all, Label label) {
  LandmarkRecord r;
  for (const Sample& s : all) {
    fuse_association_position(r, s.p_map, 1e-3);
    fuse_width(r, width_observation(0.1 + 0.02 * s.roc, 0.1 * r.num_all), 1);
    accumulate(r, s.p_map, s.roc, label, label == Label::kTree ? 0.25 : -0.25);
    ++r.num_all;
  }
  return r;
}

/// In two passes, as a textbook has it.
struct TwoPass {
  explicit TwoPass(const std::vector<Sample>& all) {
    n = static_cast<double>(all.size());
    for (const Sample& s : all) mean += s.p_map / n;
    for (const Sample& s : all) {
      squares += (s.p_map - mean) * (s.p_map - mean).transpose();
      roc_sum += s.roc;
    }
  }
  double n = 0.0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
  double roc_sum = 0.0;
};

void expect_statistics(const LandmarkRecord& r, const TwoPass& expected) {
  EXPECT_EQ(r.num_observations, static_cast<int>(expected.n));
  EXPECT_NEAR(r.mean_x_m, expected.mean.x(), 1e-9);
  EXPECT_NEAR(r.mean_y_m, expected.mean.y(), 1e-9);
  EXPECT_NEAR(r.m2_xx, expected.squares(0, 0), 1e-5 * expected.squares(0, 0));
  EXPECT_NEAR(r.m2_xy, expected.squares(0, 1), 1e-5 * expected.squares(0, 0));
  EXPECT_NEAR(r.m2_yy, expected.squares(1, 1), 1e-5 * expected.squares(1, 1));
  EXPECT_NEAR(r.roc_sum, expected.roc_sum, 1e-9);
}

std::vector<Sample> both(std::vector<Sample> a, const std::vector<Sample>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

TEST(LandmarkRecord, StandardErrorIsEquation13WithNMinus1) {
  for (const int n : {2, 3, 5, 8, 200}) {
    const auto all = samples(static_cast<std::uint64_t>(n), n);
    const LandmarkRecord r = record_of(all, Label::kTree);
    double sum_x = 0.0, sum_y = 0.0, square_x = 0.0, square_y = 0.0;
    for (const Sample& s : all) sum_x += s.p_map.x(), sum_y += s.p_map.y();
    for (const Sample& s : all) {
      square_x += std::pow(s.p_map.x() - sum_x / n, 2);
      square_y += std::pow(s.p_map.y() - sum_y / n, 2);
    }
    const double se_x_m = std::sqrt(square_x / (n - 1)) / std::sqrt(n);
    const double se_y_m = std::sqrt(square_y / (n - 1)) / std::sqrt(n);
    EXPECT_NEAR(standard_error_m(r).x(), se_x_m, 1e-4 * se_x_m) << n;
    EXPECT_NEAR(standard_error_m(r).y(), se_y_m, 1e-4 * se_y_m) << n;
  }
  EXPECT_EQ(standard_error_m(record_of(samples(1, 1), Label::kTree)).norm(), 0.0);
}

TEST(LandmarkRecord, AccumulatesAsTwoPassesDo) {
  const auto all = samples(3, 60);
  expect_statistics(record_of(all, Label::kTree), TwoPass(all));
  expect_statistics(record_of(all, Label::kUnseen), TwoPass(all));
}

TEST(LandmarkRecord, AMergerIsOnePassOverAllObservations) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto a = samples(seed, static_cast<int>(1 + seed % 7));
    const auto b = samples(seed + 100, static_cast<int>(1 + 3 * seed % 11));
    for (const Label label : {Label::kTree, Label::kUnseen}) {
      LandmarkRecord merged = record_of(a, label);
      merge(merged, record_of(b, label));
      const LandmarkRecord at_once = record_of(both(a, b), label);
      expect_statistics(merged, TwoPass(both(a, b)));
      EXPECT_NEAR(merged.association_x_m, at_once.association_x_m, 1e-6);
      EXPECT_NEAR(merged.association_y_m, at_once.association_y_m, 1e-6);
      EXPECT_NEAR(merged.association_information, at_once.association_information,
                  1e-5 * at_once.association_information);
      EXPECT_NEAR(merged.scatter_m2, at_once.scatter_m2, 1e-4 * at_once.scatter_m2 + 1e-9);
      EXPECT_NEAR(merged.width_m, at_once.width_m, 1e-6);
      EXPECT_NEAR(merged.log_odds, at_once.log_odds, 1e-5);
      EXPECT_EQ(merged.num_all, at_once.num_all);
      EXPECT_EQ(label_of(merged, {}), label);
    }
  }
}

TEST(LandmarkRecord, OfAMergerTheCameraSeenHalfCounts) {
  const auto seen = samples(1, 4);
  const auto unseen = samples(2, 9);
  LandmarkRecord seen_first = record_of(seen, Label::kObject);
  merge(seen_first, record_of(unseen, Label::kUnseen));
  LandmarkRecord seen_last = record_of(unseen, Label::kUnseen);
  merge(seen_last, record_of(seen, Label::kObject));
  for (const LandmarkRecord& r : {seen_first, seen_last}) {
    expect_statistics(r, TwoPass(seen));
    EXPECT_EQ(r.num_all, 13);
    EXPECT_EQ(label_of(r, {}), Label::kObject);
  }
}

TEST(LandmarkRecord, ProbabilityIsBayesOfTheLabels) {
  LandmarkRecord r;
  EXPECT_EQ(probability_of_tree(r, {}), 0.5);
  const double evidence = std::log(0.8 / 0.2);
  double for_tree = 1.0, for_object = 1.0;
  for (int k = 0; k < 3; ++k) {
    accumulate(r, {0.0, 0.0}, 0.9, Label::kTree, evidence);
    for_tree *= 0.8;
    for_object *= 0.2;
  }
  EXPECT_NEAR(probability_of_tree(r, {}), for_tree / (for_tree + for_object), 1e-6);
  for (int k = 0; k < 1000; ++k) accumulate(r, {0.0, 0.0}, 0.9, Label::kTree, evidence);
  EXPECT_EQ(r.log_odds, 30.0f);
}

TEST(LandmarkRecord, ByWidthAloneFiftyObservationsSayWhatOneSays) {
  // the width of a bush's stem fits a trunk each time it is measured
  MapperConfig alone, with_camera, with_reflectors;
  alone.has_camera = with_reflectors.has_camera = false;
  with_reflectors.reflector_marks_tree = true;
  const auto seen = [](int num, Label label, const MapperConfig& config) {
    LandmarkRecord r;
    detection::Detection d;
    d.label = label;
    for (int k = 0; k < num; ++k) accumulate(r, {0, 0}, 0.9, label, evidence_of(d, config));
    return probability_of_tree(r, config);
  };
  EXPECT_NEAR(seen(1, Label::kTree, alone), 0.8, 1e-6);
  EXPECT_NEAR(seen(50, Label::kTree, alone), 0.8, 1e-6);
  EXPECT_NEAR(seen(50, Label::kObject, alone), 0.2, 1e-6);
  // pictures and reflectors tell more than widths
  EXPECT_GT(seen(50, Label::kTree, with_camera), 0.999);
  EXPECT_GT(seen(50, Label::kTree, with_reflectors), 0.999);
}

/// What the mapper makes of observations with these probabilities, judged by the camera or not.
double probability_from(const std::vector<double>& observations, const MapperConfig& config,
                        Label label = Label::kObject) {
  LandmarkRecord r;
  for (const double p : observations) {
    detection::Detection d;
    d.label = label;
    d.probability_tree = static_cast<float>(p);
    d.probability_object = static_cast<float>(1.0 - p);
    accumulate(r, {0.0, 0.0}, 0.5, d.label, evidence_of(d, config), log_odds_max(config));
  }
  EXPECT_EQ(label_of(r, config) == Label::kTree, label != Label::kUnseen &&
                                                     r.num_observations > 0 &&
                                                     probability_of_tree(r, config) > 0.5);
  return probability_of_tree(r, config);
}

TEST(LandmarkRecord, ProbabilityIsBayesOfCalibratedObservations) {
  MapperConfig config;
  config.evidence = Evidence::kProbability;
  config.evidence_base_rate = 0.4;
  config.evidence_prior = 0.7;
  config.evidence_correlation = 0.0;
  EXPECT_NEAR(probability_from({}, config), 0.7, 1e-12);
  // independent observations: odds multiply, each without the base rate it holds already
  const double odds = (0.7 / 0.3) * (0.8 / 0.2) / (0.4 / 0.6) * (0.3 / 0.7) / (0.4 / 0.6);
  EXPECT_NEAR(probability_from({0.8, 0.3}, config), odds / (1.0 + odds), 1e-6);
  // observations that repeat each other wholly say what one says
  config.evidence_correlation = 1.0;
  EXPECT_NEAR(probability_from({0.8, 0.8, 0.8}, config), probability_from({0.8}, config), 1e-6);
  // an observation that says what is said of everything says nothing
  EXPECT_NEAR(probability_from({0.4, 0.4}, config), 0.7, 1e-6);
}

TEST(LandmarkRecord, OnceTheCameraObservationsItsObservationsAloneSpeak) {
  MapperConfig config;
  config.evidence = Evidence::kProbability;
  LandmarkRecord r, later;
  const auto add = [&](LandmarkRecord& record, Label label, float p) {
    detection::Detection d;
    d.label = label;
    d.probability_tree = p;
    d.probability_object = 1.0f - p;
    accumulate(record, {0, 0}, 0.5, label, evidence_of(d, config), log_odds_max(config));
  };
  add(r, Label::kUnseen, 0.9f);
  EXPECT_EQ(label_of(r, config), Label::kUnseen);
  EXPECT_NEAR(probability_of_tree(r, config), 0.9, 1e-6);
  add(r, Label::kObject, 0.2f);
  add(r, Label::kUnseen, 0.9f);
  EXPECT_NEAR(probability_of_tree(r, config), 0.2, 1e-6);
  // and so of a merger, whichever is the older
  add(later, Label::kUnseen, 0.9f);
  LandmarkRecord merged = later;
  for (LandmarkRecord* record : {&merged, &r}) {
    record->association_information = record->width_information = 1.0f;
  }
  merge(merged, r, log_odds_max(config));
  EXPECT_NEAR(probability_of_tree(merged, config), 0.2, 1e-6);
}

TEST(LandmarkRecord, AFlashOutweighsObservationsWithoutOne) {
  MapperConfig config;
  config.reflector_marks_tree = true;
  detection::Detection flash, dim;
  flash.label = Label::kTree;
  dim.label = Label::kObject;
  EXPECT_GT(evidence_of(flash, config) + 4.0 * evidence_of(dim, config), 0.0);
  EXPECT_LT(evidence_of(flash, config) + 40.0 * evidence_of(dim, config), 0.0);  // a stray gleam
  config.reflector_marks_tree = false;
  EXPECT_LT(evidence_of(flash, config) + 4.0 * evidence_of(dim, config), 0.0);
}

TEST(LandmarkWidth, IsTheMeanOfCountsAndItsStandardErrorHolds) {
  // a trunk of 3.3 beams is met by three or four: the mean is right, and as sure as it says
  constexpr double kBeam_m = 0.02, kWidth_m = 3.3 * kBeam_m;
  double squares = 0.0;
  constexpr int kSeeds = 200, kObservations = 40;
  for (int seed = 0; seed < kSeeds; ++seed) {
    std::mt19937_64 bits(static_cast<std::uint64_t>(seed));
    LandmarkRecord r;
    for (int observation = 0; observation < kObservations; ++observation) {
      const double phase = static_cast<double>(bits() >> 11) * 0x1p-53;
      const int num_beams = static_cast<int>(std::floor(kWidth_m / kBeam_m + phase));
      detection::Detection d = width_observation(num_beams * kBeam_m, 0.1 * observation);
      d.width_sd_m = kBeam_m / std::sqrt(6.0);
      d.num_beams = num_beams;
      fuse_width(r, d, 1);
    }
    squares += std::pow((r.width_m - kWidth_m) / width_sd_m(r), 2) / kSeeds;
    EXPECT_NEAR(width_sd_m(r), kBeam_m / std::sqrt(6.0 * kObservations), 0.5e-3);
  }
  // by their phases alone it is 6 p (1 - p), 1.26 of three tenths; where looks scatter, 1
  EXPECT_GT(squares, 0.7);
  EXPECT_LT(squares, 1.4);
}

TEST(LandmarkWidth, StandingStillTellsNothingNew) {
  LandmarkRecord once, often;
  fuse_width(once, width_observation(0.10), 1);
  for (int observation = 0; observation < 1000; ++observation)
    fuse_width(often, width_observation(0.10), 1);
  EXPECT_NEAR(width_sd_m(often), width_sd_m(once), 1e-3);
}

TEST(LandmarkWidth, FarObservationsThatOnlyTheWidestPassSayNothing) {
  // 70 mm fill 1.4 beams of 50 mm: with two beams at least only observations of 100 mm are handed
  // over
  LandmarkRecord r;
  for (int observation = 0; observation < 60; ++observation) {
    detection::Detection far = width_observation(0.10, 0.1 * observation);
    far.width_sd_m = 0.05 / std::sqrt(6.0);
    far.num_beams = 2;
    fuse_width(r, far, 2);
  }
  EXPECT_GT(width_sd_m(r), 0.02);  // nobody knows
  for (int observation = 0; observation < 20; ++observation) {
    detection::Detection near = width_observation(0.07, 10.0 - 0.1 * observation);
    near.width_sd_m = 0.01 / std::sqrt(6.0);
    near.num_beams = 7;
    fuse_width(r, near, 2);
  }
  EXPECT_NEAR(r.width_m, 0.07, 0.002);
}

TEST(LandmarkRecord, AObservationThatNothingJudgedSaysNothing) {
  MapperConfig config;
  config.evidence = Evidence::kProbability;
  detection::Detection d;
  d.label = Label::kObject;
  EXPECT_EQ(evidence_of(d, config), 0.0);
  config.evidence = Evidence::kLabels;
  EXPECT_NEAR(evidence_of(d, config), std::log(0.2 / 0.8), 1e-12);
}

}  // namespace
}  // namespace orchard::mapping
