// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "mapping/compare/alignment_candidates.hpp"
#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// The trunks of one map that alignment goes by.
struct AlignmentTrunks {
  IndexedPoints places;
  std::vector<double> width_m;
  /// Whether a trunk at that place (in this map's frame) would stand in this map.
  std::function<bool(const Eigen::Vector2d&)> is_looked_at;
};

/// How well one way of laying b on a explains each trunk: log likelihoods against trunks that only
/// stand in rows alike, NaN for a trunk that it puts where the other drive cannot judge.
struct AlignmentEvidence {
  std::vector<double> of_a;
  std::vector<double> of_b;
};

/// How pairs of one trunk differ between the two maps.
struct PairNoise {
  double position_sd_m = 0.02;  ///< per axis
  double width_offset_m = 0.0;  ///< of b against a
  double width_sd_m = 0.01;
  double width_mean_m = 0.1;  ///< of all trunks of b
  double width_spread_m = 0.02;
  double gate_m = 0.5;
};

/// Noise as the pairs of one way show it.
PairNoise pair_noise(const AlignmentTrunks& a, const AlignmentTrunks& b,
                     const std::vector<LandmarkPair>& pairs, double gate_m);

/// How trunks differ that are paired by chance, as planted alike: the median of all ways' noise;
/// where there are but few ways, anything within the gate.
PairNoise chance_noise(const std::vector<PairNoise>& of_ways);

/// What may be believed of a way's own noise when it has few pairs, whose luck it may be.
PairNoise cautious(const PairNoise& own, const PairNoise& chance, std::size_t num_pairs);

AlignmentEvidence evidence_of(const AlignmentTrunks& a, const AlignmentTrunks& b,
                              const AlignmentCandidate& way, const PairNoise& noise,
                              const PairNoise& chance);

/// By how much something explains the maps better.
struct EvidenceDifference {
  double log_odds = 0.0;
  double sigmas = 0.0;  ///< Vuong's statistic
};

/// Of the first way against the second; what one of them cannot judge is as if by chance.
EvidenceDifference difference(const AlignmentEvidence& first, const AlignmentEvidence& second);

/// Of a way against trunks that are others, planted alike: only what places and widths of b say.
EvidenceDifference detail(const AlignmentEvidence& evidence);

/// Trunks of b that the way puts where the first drive can judge.
std::size_t num_judged_b(const AlignmentEvidence& evidence);

/// Share of the trunks of b that the way pairs, of those it puts where the first drive looked.
double share_explained(const AlignmentEvidence& evidence, std::size_t num_pairs);

}  // namespace orchard::mapping
