// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/plan/orchard_plan.hpp"

#include <algorithm>

#include "geometry/point_grid.hpp"
#include "geometry/statistics.hpp"

namespace orchard::mapping {

using Eigen::Vector2d;

std::size_t OrchardPlan::num_trees() const {
  std::size_t num = 0;
  for (const PlannedRow& row : rows) num += row.trees.size();
  return num;
}

std::vector<Vector2d> OrchardPlan::places() const {
  std::vector<Vector2d> places;
  for (const PlannedRow& row : rows) {
    for (const PlannedTree& tree : row.trees) places.push_back(tree.p_plan);
  }
  return places;
}

std::vector<PlanIndex> plan_indices(const OrchardPlan& plan) {
  std::vector<PlanIndex> indices;
  for (std::size_t r = 0; r < plan.rows.size(); ++r) {
    for (std::size_t k = 0; k < plan.rows[r].trees.size(); ++k) {
      indices.push_back({static_cast<std::int32_t>(r), static_cast<std::int32_t>(k)});
    }
  }
  return indices;
}

std::vector<Vector2d> directions_along_rows(const OrchardPlan& plan) {
  Vector2d usual(1.0, 0.0);
  for (const PlannedRow& row : plan.rows) {
    if (row.trees.size() < 2) continue;
    usual = (row.trees.back().p_plan - row.trees.front().p_plan).stableNormalized();
    break;
  }
  std::vector<Vector2d> directions;
  for (const PlannedRow& row : plan.rows) {
    for (std::size_t k = 0; k < row.trees.size(); ++k) {
      const Vector2d d = row.trees[std::min(k + 1, row.trees.size() - 1)].p_plan -
                         row.trees[k > 0 ? k - 1 : 0].p_plan;
      directions.push_back(d.norm() > 1e-6 ? d.normalized() : usual);
    }
  }
  return directions;
}

PlannedRowFacts row_facts(const PlannedRow& row) {
  PlannedRowFacts facts;
  std::vector<double> steps_m;
  for (std::size_t k = 1; k < row.trees.size(); ++k) {
    steps_m.push_back((row.trees[k].p_plan - row.trees[k - 1].p_plan).norm());
    facts.length_m += steps_m.back();
  }
  if (steps_m.empty()) return facts;
  facts.spacing_min_m = *std::min_element(steps_m.begin(), steps_m.end());
  facts.spacing_max_m = *std::max_element(steps_m.begin(), steps_m.end());
  facts.spacing_m = geometry::median(std::move(steps_m));
  return facts;
}

double typical_alley_m(const OrchardPlan& plan) {
  constexpr double kWidestAlley_m = 30.0;
  constexpr std::size_t kNumAsked = 2000;
  const std::vector<PlanIndex> indices = plan_indices(plan);
  const geometry::IndexedPoints places(plan.places());
  const std::size_t step = std::max<std::size_t>(1, places.size() / kNumAsked);
  std::vector<double> alleys_m;
  for (std::size_t i = 0; i < places.size(); i += step) {
    // Expanding search radius: rows are near, and a wide search is expensive.
    for (double reach_m = 4.0; reach_m < 2.0 * kWidestAlley_m; reach_m *= 2.0) {
      double nearest_m = 1e300;
      for (const std::int32_t j : places.within(places[i], reach_m)) {
        if (indices[static_cast<std::size_t>(j)].row == indices[i].row) continue;
        nearest_m = std::min(nearest_m, (places[static_cast<std::size_t>(j)] - places[i]).norm());
      }
      if (nearest_m > reach_m) continue;
      alleys_m.push_back(nearest_m);
      break;
    }
  }
  return geometry::median(std::move(alleys_m));
}

}  // namespace orchard::mapping
