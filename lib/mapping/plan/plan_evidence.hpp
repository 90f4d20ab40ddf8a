// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "mapping/compare/landmark_pairing.hpp"

namespace orchard::mapping {

/// What is known of the trees that are laid upon each other.
struct PlanNoise {
  double position_sd_m = 0.1;  ///< of a tree about its place, per axis
  double gate_m = 0.5;         ///< farthest that a pair lies apart
  double trees_per_m2 = 0.1;   ///< of the plan
};

/// Probability that the drive misses a tree that stands at a position of map.
using MissedAt = std::function<double(const Eigen::Vector2d& p_map)>;

/// Log-likelihood of trees, planned and mapped, under one placement of the plan: each with a prior
/// of one in twenty that a planned tree is missing or a mapped one extra.
double plan_log_likelihood(const IndexedPoints& planned, const geometry::Pose2& T_map_plan,
                           const std::vector<LandmarkPair>& pairs, const PlanNoise& noise,
                           const MissedAt& missed);

/// Log-likelihood of a pair's distance, against a mapped tree that is extra.
double pair_gain(double distance_m, const PlanNoise& noise);

/// Of a planned tree without partner.
double missing_log_likelihood(double probability_missed);

}  // namespace orchard::mapping
