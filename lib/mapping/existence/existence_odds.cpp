// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/existence/existence_odds.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::mapping {
namespace {

/// Probability that beams pass through the position of an existing object: thin objects and wrong
/// poses.
constexpr double kPassRate = 0.1;

/// Probability that they pass if the object is gone; less than 1 because another may be in front.
constexpr double kPassRateGone = 0.7;

/// Number of beams across an object from which their evidence has full weight.
constexpr int kFullBeams = 6;

/// Upper limit of pose_weight().
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
