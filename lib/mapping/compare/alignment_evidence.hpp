// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "mapping/compare/alignment_candidates.hpp"
#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// Trunks of one map used for registration.
struct AlignmentTrunks {
  geometry::IndexedPoints places;
  std::vector<double> width_m;
  std::vector<const Landmark*> landmarks;
  /// Probability that an existing trunk of the other map, at a position in this map's frame, is
  /// missing from this map, given its repeat rate.
  std::function<double(const Eigen::Vector2d&, const Landmark& of_other)> missed;
};

/// Log-likelihood ratio of each trunk, alignment hypothesis against null hypothesis (different
/// trunks in the same planting pattern); 0 for a trunk that the other drive would not have mapped.
struct AlignmentEvidence {
  std::vector<double> of_a;
  std::vector<double> of_b;
  double num_judged_b = 0.0;  ///< expected number of trunks of b that the first drive maps
};

/// Noise model of the pairs: differences of one trunk between the two maps.
struct PairNoise {
  double position_sd_m = 0.02;  ///< per axis
  double width_offset_m = 0.0;  ///< b minus a
  double width_sd_m = 0.01;
  double width_mean_m = 0.1;  ///< of all trunks of b
  double width_spread_m = 0.02;
  double gate_m = 0.5;
};

/// Noise of the pairs of one hypothesis.
PairNoise pair_noise(const AlignmentTrunks& a, const AlignmentTrunks& b,
                     const std::vector<LandmarkPair>& pairs, double gate_m);

/// Noise of pairs under the null hypothesis (lattice aliasing): the median over all hypotheses, or
/// uniform within the gate if there are too few.
PairNoise null_noise(const std::vector<PairNoise>& of_hypotheses);

/// Shrinks the noise of a hypothesis with few pairs towards that of the null hypothesis.
PairNoise shrunk_noise(const PairNoise& own, const PairNoise& null, std::size_t num_pairs);

/// Log-likelihood ratios of all trunks for one hypothesis. `noise`: of its pairs; `null`: of the
/// null hypothesis.
AlignmentEvidence evidence_of(const AlignmentTrunks& a, const AlignmentTrunks& b,
                              const AlignmentCandidate& candidate, const PairNoise& noise,
                              const PairNoise& null);

/// Difference of two log-likelihoods.
struct EvidenceDifference {
  double log_odds = 0.0;
  double sigmas = 0.0;  ///< Vuong's statistic
};

/// Log-odds of hypothesis 1 against 2; trunks that would be missed get the null likelihood.
EvidenceDifference compare_hypotheses(const AlignmentEvidence& first,
                                      const AlignmentEvidence& second);

/// Log-odds of a hypothesis against the null hypothesis, from the positions and widths of b only.
EvidenceDifference log_odds_against_null(const AlignmentEvidence& evidence);

/// Number of pairs divided by the expected number of b's trunks that the first drive maps.
double fraction_explained(const AlignmentEvidence& evidence, std::size_t num_pairs);

}  // namespace orchard::mapping
