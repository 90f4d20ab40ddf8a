// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <set>
#include <string>
#include <utility>

#include "mapping/plan/plan_match.hpp"
#include "unit/mapping/compare/two_drives.hpp"

namespace orchard::mapping {

/// How an orchard was planted, against its plan.
struct Planting {
  double missing = 0.05;
  double extra = 0.02;
  double out_of_place = 0.01;
  double planting_sd_m = 0.06;
  bool shift_a_row = true;
  bool is_rectangle = false;  ///< else rows begin and end where they like
};

/// A plan, what truly stands, and what differs; by row and tree names.
struct PlannedBlock {
  OrchardPlan plan;  ///< frame of the block
  Block block;       ///< row, place: indices into the plan; place -1: extra
  std::set<std::pair<std::string, std::string>> missing, out_of_place;
  std::set<int> extra;  ///< indices into block.trees
  std::string shifted_row;
  Eigen::Vector2d shift{0, 0};
};

/// A random orchard: 6 to 14 rows of up to 40 trees. Extra trees stand between two places whose
/// trees are there; one row, when asked for, stands elsewhere by 0.5 m to 0.4 of a spacing along or
/// of an aisle aside.
inline PlannedBlock plant_to_plan(Dice& dice, const Planting& planting) {
  PlannedBlock b;
  const int num_rows = 6 + static_cast<int>(dice.uniform(0, 9));
  const int num_trees = 18 + static_cast<int>(dice.uniform(0, 23));
  b.block.num_rows = num_rows;
  b.block.num_places = num_trees;
  b.block.tree_spacing_m = dice.uniform(1.5, 4.0);
  b.block.row_spacing_m = std::max(b.block.tree_spacing_m, dice.uniform(3.0, 5.5));
  const double s = b.block.tree_spacing_m;
  const int first_name = 1 + static_cast<int>(dice.uniform(0, 30));
  const bool counts_back = dice.uniform(0, 1) < 0.5;
  const int shifted =
      planting.shift_a_row ? 1 + static_cast<int>(dice.uniform(0, num_rows - 2)) : -1;
  if (shifted >= 0) {
    const double sign = dice.uniform(0, 1) < 0.5 ? -1.0 : 1.0;
    const bool is_along = dice.uniform(0, 1) < 0.7;
    const double most_m = 0.4 * (is_along ? s : b.block.row_spacing_m);
    const double way_m = sign * dice.uniform(0.5, std::max(0.55, most_m));
    b.shift = is_along ? Eigen::Vector2d(way_m, 0.0) : Eigen::Vector2d(0.0, way_m);
  }
  int begin = 0, end = num_trees;
  for (int r = 0; r < num_rows; ++r) {
    if (!planting.is_rectangle && r % 2 == 0) {
      begin = static_cast<int>(dice.uniform(0, 4));
      end = num_trees - static_cast<int>(dice.uniform(0, 6));
    }
    PlannedRow row;
    row.name = std::to_string(first_name + r);
    const Eigen::Vector2d shift = r == shifted ? b.shift : Eigen::Vector2d(0, 0);
    if (r == shifted) b.shifted_row = row.name;
    std::vector<TrueTree> trees;
    for (int k = begin; k < end; ++k) {
      PlannedTree planned;
      planned.name = std::to_string(counts_back ? end - k : k - begin + 1);
      planned.p_plan = {k * s, r * b.block.row_spacing_m};
      TrueTree t;
      t.row = r;
      t.place = k - begin;
      t.p =
          planned.p_plan + shift +
          Eigen::Vector2d(dice.normal(planting.planting_sd_m), dice.normal(planting.planting_sd_m));
      t.width_m = std::max(0.05, 0.12 + dice.normal(0.02));
      t.stands = dice.uniform(0, 1) >= planting.missing;
      if (!t.stands) {
        b.missing.insert({row.name, planned.name});
      } else if (r != shifted && dice.uniform(0, 1) < planting.out_of_place) {
        const double way_m = dice.uniform(0.5, 0.6) * (dice.uniform(0, 1) < 0.5 ? -1.0 : 1.0);
        t.p += Eigen::Vector2d(way_m, 0.0);
        b.out_of_place.insert({row.name, planned.name});
      }
      trees.push_back(t);
      row.trees.push_back(planned);
    }
    const std::size_t num_planned = trees.size();
    for (std::size_t k = 0; k + 1 < num_planned; ++k) {
      if (dice.uniform(0, 1) >= planting.extra || !trees[k].stands || !trees[k + 1].stands)
        continue;
      TrueTree t = trees[k];
      t.place = -1;
      t.p = 0.5 * (trees[k].p + trees[k + 1].p);
      b.extra.insert(static_cast<int>(b.block.trees.size() + trees.size()));
      trees.push_back(t);
    }
    if (counts_back) std::reverse(row.trees.begin(), row.trees.end());
    for (TrueTree& t : trees) {
      if (counts_back && t.place >= 0) t.place = end - begin - 1 - t.place;
      b.block.trees.push_back(t);
    }
    b.plan.rows.push_back(std::move(row));
  }
  return b;
}

/// A drive down every aisle of it, with a slow bend.
inline DrivenMap drive_all(PlannedBlock& b, const geometry::Pose2& T_map_block, Dice& dice) {
  Drive drive;
  drive.last_aisle = b.block.num_rows;
  drive.along_max_m = (b.block.num_places - 1) * b.block.tree_spacing_m + 3.0;
  drive.T_map_block = T_map_block;
  return drive_through(b.block, drive, dice);
}

/// Adds what a laser takes for trunks: bushes at random on a headland of 30 m at both ends of the
/// rows, at least 2 m from the planted ground.
inline void add_bushes(const PlannedBlock& b, std::size_t num, const geometry::Pose2& T_map_block,
                       Dice& dice, DrivenMap& map) {
  const double end_m = (b.block.num_places - 1) * b.block.tree_spacing_m;
  const double side_m = b.block.num_rows * b.block.row_spacing_m;
  Landmark bush = map.landmarks.front();
  for (std::size_t k = 0; k < num; ++k) {
    const double out_m = dice.uniform(2.0, 30.0), aside_m = dice.uniform(0.0, side_m);
    const Eigen::Vector2d p =
        transform(T_map_block, Eigen::Vector2d(k % 2 == 0 ? -out_m : end_m + out_m, aside_m));
    bush.id = 100000 + static_cast<std::int32_t>(k);
    bush.x_m = p.x();
    bush.y_m = p.y();
    map.landmarks.push_back(bush);
    map.tree_of.push_back(-1);
  }
}

/// How well a match agrees with the truth.
struct PlanScore {
  int num_named = 0, num_misnamed = 0;
  int num_true = 0, num_false = 0, num_overlooked = 0;  ///< deviations

  double precision() const { return num_true / std::max(1.0, double(num_true + num_false)); }
  double recall() const { return num_true / std::max(1.0, double(num_true + num_overlooked)); }
  void add(const PlanScore& o) {
    num_named += o.num_named;
    num_misnamed += o.num_misnamed;
    num_true += o.num_true;
    num_false += o.num_false;
    num_overlooked += o.num_overlooked;
  }
};

/// Names count for each mapped tree that was planned; deviations are missing, extra and out of
/// place trees and the shifted row.
inline PlanScore score_of(const PlannedBlock& b, const DrivenMap& map, const OrchardPlan& plan,
                          const PlanMatch& match) {
  PlanScore score;
  std::set<std::pair<std::string, std::string>> missing, out_of_place;
  std::set<int> extra;
  std::vector<std::pair<std::string, std::string>> name_of(map.landmarks.size());
  for (const PlanFinding& f : match.findings) {
    if (f.deviation == PlanDeviation::kExtra) {
      extra.insert(map.tree_of[static_cast<std::size_t>(f.landmark)]);
      continue;
    }
    const PlannedRow& row = plan.rows[static_cast<std::size_t>(f.row)];
    const std::pair<std::string, std::string> name{
        row.name, row.trees[static_cast<std::size_t>(f.tree)].name};
    if (f.deviation == PlanDeviation::kMissing) missing.insert(name);
    if (f.deviation == PlanDeviation::kOutOfPlace) out_of_place.insert(name);
    const bool is_tree =
        f.deviation == PlanDeviation::kAsPlanned || f.deviation == PlanDeviation::kOutOfPlace;
    if (is_tree) name_of[static_cast<std::size_t>(f.landmark)] = name;
  }
  std::set<int> extra_mapped;
  for (std::size_t i = 0; i < map.landmarks.size(); ++i) {
    const int index = map.tree_of[i];
    if (index < 0) {  // a bush has no name
      score.num_misnamed += name_of[i].first.empty() ? 0 : 1;
      continue;
    }
    const TrueTree& t = b.block.trees[static_cast<std::size_t>(index)];
    if (b.extra.count(index) > 0) {
      extra_mapped.insert(index);
      continue;
    }
    const PlannedRow& row = b.plan.rows[static_cast<std::size_t>(t.row)];
    const bool is_right =
        name_of[i] == std::pair<std::string, std::string>{
                          row.name, row.trees[static_cast<std::size_t>(t.place)].name};
    ++(is_right ? score.num_named : score.num_misnamed);
  }
  const auto tally = [&score](const auto& truth, const auto& found) {
    for (const auto& f : found) ++(truth.count(f) > 0 ? score.num_true : score.num_false);
    for (const auto& t : truth) score.num_overlooked += found.count(t) == 0;
  };
  tally(b.missing, missing);
  tally(b.out_of_place, out_of_place);
  tally(extra_mapped, extra);
  std::set<std::string> shifted_truth, shifted;
  if (!b.shifted_row.empty()) shifted_truth.insert(b.shifted_row);
  for (std::size_t r = 0; r < match.rows.size(); ++r) {
    if (match.rows[r].is_shifted) shifted.insert(plan.rows[r].name);
  }
  tally(shifted_truth, shifted);
  return score;
}

}  // namespace orchard::mapping
