// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/compare/coverage.hpp"
#include "mapping/plan/orchard_plan.hpp"
#include "mapping/plan/plan_fit.hpp"
#include "mapping/plan/row_shift.hpp"

namespace orchard::mapping {

struct PlanMatchConfig {
  MapAlignmentConfig alignment;
  double tolerance_m = 0.3;  ///< a tree this near to its place stands as planned
  int placement = 0;         ///< which of several that fit equally, from 1; 0: refuse them
};

enum class PlanDeviation {
  kAsPlanned,
  kOutOfPlace,  ///< farther than the tolerance from its place, its row's own shift apart
  kMissing,     ///< the drive would have seen it
  kNotSeen,     ///< no tree there, and the drive did not look well enough
  kExtra,       ///< a tree that the plan has not
};
inline constexpr int kNumPlanDeviations = 5;

/// as_planned, missing ...: as files write it.
const char* deviation_text(PlanDeviation deviation);

/// What became of one planned tree, or one mapped tree that is extra.
struct PlanFinding {
  PlanDeviation deviation = PlanDeviation::kAsPlanned;
  std::int32_t row = -1;        ///< index into the plan; of an extra tree the row it stands in
  std::int32_t tree = -1;       ///< index into the row; of an extra tree the one before it, or -1
  std::int32_t landmark = -1;   ///< index into the map; at an empty place an object that is there
  Eigen::Vector2d p_map{0, 0};  ///< where it stands, or was to stand
  double along_m = 0.0;     ///< from the planned place towards the row's last tree; 0 without tree
  double aside_m = 0.0;     ///< to the left of that
  double confidence = 0.0;  ///< that a missing one is missing, in [0, 1]; else 1
};

/// What became of a row.
struct PlanRowFinding {
  std::array<int, kNumPlanDeviations> counts{};
  RowShift shift;           ///< against the plan as a whole
  bool is_shifted = false;  ///< against its neighbouring rows, by more than the tolerance
};

struct PlanMatch {
  PlanFit fit;
  std::size_t placement = 0;          ///< the one of fit.placements that was taken
  std::vector<PlanFinding> findings;  ///< planned trees in order of the plan, then extra ones
  std::vector<PlanRowFinding> rows;   ///< as in the plan
  std::array<int, kNumPlanDeviations> counts{};
  double rms_m = 0.0;  ///< of trees about their places, shifted rows apart

  bool is_laid() const { return !findings.empty(); }
  const geometry::Pose2& T_map_plan() const { return fit.placements[placement].T_map_plan; }
};

/// Finds the planned trees in a map: lays the plan on it (fit_plan()), finds rows that stand
/// elsewhere as a whole (shift_of_row()), and pairs trees and places one to one, near ones first,
/// within 0.45 of the spacing. Objects are no trees. Where the plan cannot be laid, or can in
/// several ways and none was chosen, findings stay empty and fit.reason says why.
PlanMatch match_plan(const OrchardPlan& plan, const std::vector<Landmark>& landmarks,
                     const DetectionMap& view, const PlanMatchConfig& config);

}  // namespace orchard::mapping
