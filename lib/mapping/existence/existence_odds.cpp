// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/existence/existence_odds.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::mapping {
namespace {

/// Probability that beams pass through where a standing thing is: thin things and wrong poses.
constexpr double kPassRate = 0.1;

/// The same where a thing is gone: something else may stand in front.
constexpr double kPassRateGone = 0.7;

/// Beams across a thing from which on their evidence counts in full.
constexpr int kFullBeams = 6;

/// The weight of a landmark in whether a scan's pose can be trusted is its number of observations,
/// up to this.
constexpr int kPoseWeightMax = 100;

}  // namespace

double log_odds_of_return() { return std::log((1.0 - kPassRate) / (1.0 - kPassRateGone)); }

double log_odds_of(const FreeSpaceAnswer& answer, BeamWeight weight) {
  const double fraction = weight == BeamWeight::kFull
                              ? 1.0
                              : std::min(1.0, static_cast<double>(answer.num_across) / kFullBeams);
  switch (answer.evidence) {
    case FreeSpaceEvidence::kUnknown:
      break;
    case FreeSpaceEvidence::kReturns:
      return log_odds_of_return();
    case FreeSpaceEvidence::kPassesThrough:
      return fraction * fraction * std::log(kPassRate / kPassRateGone);
  }
  return 0.0;
}

int pose_weight(int num_observations) { return std::min(num_observations, kPoseWeightMax); }

}  // namespace orchard::mapping
