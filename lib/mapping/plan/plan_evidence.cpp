// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/plan/plan_evidence.hpp"

#include <cmath>

#include "geometry/angles.hpp"

namespace orchard::mapping {
namespace {

/// derived: fraction of pairs with a tree anywhere within the gate: missing ones and extra ones.
constexpr double kStrayPair = 2.0 * kRare;

}  // namespace

double pair_gain(double distance_m, const PlanNoise& noise) {
  const double variance_m2 = noise.position_sd_m * noise.position_sd_m;
  const double near_m2 =
      std::exp(-0.5 * distance_m * distance_m / variance_m2) / (2.0 * geometry::kPi * variance_m2);
  const double stray_m2 = 1.0 / (geometry::kPi * noise.gate_m * noise.gate_m);
  const double pair_m2 = (1.0 - kStrayPair) * near_m2 + kStrayPair * stray_m2;
  return std::log((1.0 - kRare) * pair_m2 / noise.extra_per_m2);
}

double missing_log_likelihood(double probability_missed) {
  return std::log(kRare + (1.0 - kRare) * probability_missed);
}

double plan_log_likelihood(const geometry::IndexedPoints& planned,
                           const geometry::Pose2& T_map_plan,
                           const std::vector<LandmarkPair>& pairs, const PlanNoise& noise,
                           const MissProbability& missed) {
  double log = 0.0;
  std::vector<bool> has_partner(planned.size(), false);
  for (const LandmarkPair& pair : pairs) {
    log += pair_gain(pair.residual_m.norm(), noise);
    has_partner[static_cast<std::size_t>(pair.b)] = true;
  }
  for (std::size_t j = 0; j < planned.size(); ++j) {
    if (!has_partner[j]) {
      log += missing_log_likelihood(missed(transform(T_map_plan, planned[j])));
    }
  }
  return log;
}

}  // namespace orchard::mapping
