// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "geometry/pose2.hpp"
#include "mapping/compare/map_alignment.hpp"
#include "mapping/plan/plan_evidence.hpp"

namespace orchard::mapping {

/// A way to lay a plan on a map.
struct PlanPlacement {
  geometry::Pose2 T_map_plan;
  std::vector<LandmarkPair> pairs;  ///< a: mapped, b: planned
  double log_odds = 0.0;            ///< of the best placement against this one
};

struct PlanFit {
  AlignmentStatus status = AlignmentStatus::kNone;
  /// The best placement first, then those that explain the map about as well; empty: none.
  std::vector<PlanPlacement> placements;
  double position_sd_m = 0.0;  ///< of trees about their places, per axis
  std::string reason;          ///< why not, as a sentence without a full stop
};

/// Lays the places of a plan rigidly on a map's trees.
///
/// `any_place` of `config` is for a map and a plan that have nothing in common but the orchard;
/// else the plan is in the frame of the map already, within the limits of `config`. Every shift and
/// turn that lays many places upon trees is tried; the best must beat every other one by odds of a
/// thousand to one, four trees counted as one: by trees without place, and places without tree
/// where `missed` says that the drive would have seen it.
/// Deterministic.
PlanFit fit_plan(const IndexedPoints& mapped, const IndexedPoints& planned, const MissedAt& missed,
                 const MapAlignmentConfig& config);

}  // namespace orchard::mapping
