// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include "mapping/compare/visibility.hpp"
#include "mapping/plan/orchard_plan.hpp"
#include "mapping/plan/plan_evidence.hpp"
#include "mapping/plan/plan_fit.hpp"
#include "mapping/rows/rows.hpp"

namespace orchard::mapping {

/// Offset of a row from its planned position.
struct RowShift {
  double along_m = 0.0;  ///< towards the last tree of the row
  double aside_m = 0.0;  ///< to the left
  int num_trees = 0;     ///< number of trees used
};

/// One row of the plan, transformed to map.
struct RegisteredRow {
  std::vector<Eigen::Vector2d> places_map;
  std::vector<Eigen::Vector2d> along;      ///< unit vectors in map
  std::vector<Eigen::Vector2d> trees_map;  ///< mapped trees that are nearest to this row
};

/// Finds the shift of a row that was planted elsewhere as a whole: up to 1.2 spacings along and
/// less than half an aisle to the side. Maximises the likelihood of trees and empty positions, with
/// a prior of one shifted row in fifty. The shift is the median offset of the trees.
RowShift shift_of_row(const RegisteredRow& row, double spacing_m, const PlanNoise& noise,
                      const MissProbability& missed);

/// Configuration of match_plan().
struct PlanMatchConfig {
  MapAlignmentConfig alignment;
  double tolerance_m = 0.3;  ///< max distance from its position of a tree as planned
  int placement = 0;         ///< selects one of several equal placements, from 1; 0: none
};

/// Deviation of a tree from the plan.
enum class PlanDeviation {
  kAsPlanned,
  kOutOfPlace,  ///< farther than the tolerance from its position in the shifted row
  kMissing,     ///< no tree, and the drive would have seen one
  kNotSeen,     ///< no tree, but the drive did not observe the position well enough
  kExtra,       ///< a mapped tree that is not planned
};
inline constexpr int kNumPlanDeviations = 5;  // derived: of the list above

/// Text of a deviation in files: as_planned, missing, ...
const char* deviation_text(PlanDeviation deviation);

/// Result for one planned tree, or for one extra tree of the map.
struct PlanFinding {
  PlanDeviation deviation = PlanDeviation::kAsPlanned;
  std::int32_t row = -1;        ///< index into the plan; of an extra tree, its row or -1
  std::int32_t tree = -1;       ///< index into the row; of an extra tree, the one before it or -1
  std::int32_t landmark = -1;   ///< index into the map; at an empty position, an object there
  Eigen::Vector2d p_map{0, 0};  ///< actual, or planned if there is no tree
  double along_m = 0.0;         ///< offset from the planned position along the row; 0 without tree
  double aside_m = 0.0;         ///< offset to the left
  double confidence = 0.0;      ///< probability that a missing tree is missing, in [0, 1]; else 1
};

/// Result for one row.
struct PlanRowFinding {
  std::array<int, kNumPlanDeviations> counts{};
  RowShift shift;           ///< relative to the plan as a whole
  bool is_shifted = false;  ///< more than the tolerance relative to the neighbouring rows
};

/// Result of match_plan().
struct PlanMatch {
  PlanFit fit;
  std::size_t placement = 0;          ///< index of the selected placement in fit.placements
  std::vector<PlanFinding> findings;  ///< planned trees in order of the plan, then extra trees
  std::vector<PlanRowFinding> rows;   ///< as in the plan
  std::array<int, kNumPlanDeviations> counts{};
  double rms_m = 0.0;  ///< of trees about their positions, without shifted rows

  bool is_registered() const { return !findings.empty(); }
  const geometry::Pose2& T_map_plan() const { return fit.placements[placement].T_map_plan; }
};

/// Finds the planned trees in a map: registers the plan (fit_plan()), finds rows that are shifted
/// as a whole (shift_of_row()), and pairs trees with planned positions one to one within 0.45 of
/// the spacing, nearest first. Objects are not trees. If the plan cannot be placed, or is ambiguous
/// and no placement was selected, `findings` is empty and fit.reason explains why.
PlanMatch match_plan(const OrchardPlan& plan, const std::vector<Landmark>& landmarks,
                     const DetectionMap& view, const PlanMatchConfig& config);

/// The names of a landmark in the plan.
struct PlanName {
  std::string row;
  std::string tree;
};
using PlanNames = std::map<std::int32_t, PlanName>;  ///< by landmark id

/// Numbers the landmarks and rows of a map by its plan. Names are used as numbers if they are all
/// different whole numbers; else rows, or the trees of a row, are counted in the order of the plan.
/// Trees that are not planned get neither row nor position: beside a row, they may be bushes.
PlanNames number_by_plan(const OrchardPlan& plan, const PlanMatch& match,
                         std::vector<Landmark>& landmarks);

/// The plan's names of the rows that are not named by their number, by row number.
RowNames plan_row_names(const std::vector<Landmark>& landmarks, const PlanNames& names);

}  // namespace orchard::mapping
