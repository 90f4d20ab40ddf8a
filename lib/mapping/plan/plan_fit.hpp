// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "geometry/pose2.hpp"
#include "mapping/compare/map_alignment.hpp"
#include "mapping/plan/plan_evidence.hpp"

namespace orchard::mapping {

/// A placement of a plan on a map.
struct PlanPlacement {
  geometry::Pose2 T_map_plan;
  std::vector<LandmarkPair> pairs;  ///< a: mapped, b: planned
  double log_odds = 0.0;            ///< best placement against this one
};

struct PlanFit {
  AlignmentStatus status = AlignmentStatus::kNone;
  /// The best placement first, then rivals that explain the map about equally well; may be empty.
  std::vector<PlanPlacement> placements;
  PlanNoise noise;     ///< of the best placement
  std::string reason;  ///< reason for a failure, a sentence without full stop
};

/// Registers the positions of a plan rigidly with the trees of a map.
///
/// With `any_place` of `config` the frames are unrelated; else the plan must be in the map's frame
/// within the limits of `config`. Every shift and rotation that puts many planned positions onto
/// trees is evaluated. The best one must beat every other, and that none is right and all trees are
/// extra, by odds of a thousand to one, with four trees counted as one. Positions without tree
/// count as far as the drive would have seen one (`missed`). Deterministic.
PlanFit fit_plan(const geometry::IndexedPoints& mapped, const geometry::IndexedPoints& planned,
                 const MissProbability& missed, const MapAlignmentConfig& config);

}  // namespace orchard::mapping
