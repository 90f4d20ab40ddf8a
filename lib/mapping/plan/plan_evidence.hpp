// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "mapping/compare/landmark_pairing.hpp"

namespace orchard::mapping {

/// Noise model of paired planned and mapped trees.
struct PlanNoise {
  double position_sd_m = 0.1;   ///< of a tree about its planned position, per axis
  double gate_m = 0.5;          ///< max distance of a pair
  double extra_per_m2 = 0.005;  ///< density of mapped trees that are not planned
};

/// Probability that the drive misses an existing tree at a position in map.
using MissProbability = std::function<double(const Eigen::Vector2d& p_map)>;

/// derived: fraction of missing planned trees, and the smallest of extra trees to planned ones, as
/// kChangedFraction.
inline constexpr double kRare = 0.05;

/// Log-likelihood of the planned and mapped trees for one placement of the plan. Prior: one planned
/// tree in twenty is missing.
double plan_log_likelihood(const geometry::IndexedPoints& planned,
                           const geometry::Pose2& T_map_plan,
                           const std::vector<LandmarkPair>& pairs, const PlanNoise& noise,
                           const MissProbability& missed);

/// Log-likelihood ratio of a pair at this distance, against an extra mapped tree.
double pair_gain(double distance_m, const PlanNoise& noise);

/// Log-likelihood of a planned tree without partner.
double missing_log_likelihood(double probability_missed);

}  // namespace orchard::mapping
