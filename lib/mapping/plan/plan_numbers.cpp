// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/plan/plan_numbers.hpp"

#include <algorithm>
#include <set>

#include "mapping/plan/plan_building.hpp"

namespace orchard::mapping {
namespace {

std::vector<std::int32_t> numbers_of(const std::vector<std::string>& names) {
  std::vector<std::int32_t> numbers;
  for (const std::string& name : names) numbers.push_back(number_in_name(name));
  const std::set<std::int32_t> distinct(numbers.begin(), numbers.end());
  if (distinct.size() == names.size() && distinct.count(0) == 0) return numbers;
  for (std::size_t i = 0; i < names.size(); ++i) numbers[i] = static_cast<std::int32_t>(i) + 1;
  return numbers;
}

}  // namespace

std::vector<PlanName> number_by_plan(const OrchardPlan& plan, const PlanMatch& match,
                                     std::vector<Landmark>& landmarks) {
  std::vector<std::string> row_names;
  for (const PlannedRow& row : plan.rows) row_names.push_back(row.name);
  const std::vector<std::int32_t> row_numbers = numbers_of(row_names);
  std::vector<std::vector<std::int32_t>> tree_numbers;
  for (std::size_t r = 0; r < plan.rows.size(); ++r) {
    std::vector<std::string> names;
    for (const PlannedTree& tree : plan.rows[r].trees) names.push_back(tree.name);
    tree_numbers.push_back(numbers_of(names));
  }
  for (Landmark& l : landmarks) l.row = l.position = 0;
  std::vector<PlanName> name_of(landmarks.size());
  for (const PlanFinding& f : match.findings) {
    if (f.row < 0) continue;
    const auto r = static_cast<std::size_t>(f.row);
    const bool is_extra = f.deviation == PlanDeviation::kExtra;
    const bool is_tree = is_extra || f.deviation == PlanDeviation::kAsPlanned ||
                         f.deviation == PlanDeviation::kOutOfPlace;
    const auto k = static_cast<std::size_t>(std::max(0, f.tree));
    if (!is_tree) continue;
    Landmark& l = landmarks[static_cast<std::size_t>(f.landmark)];
    l.row = row_numbers[r];
    l.position = is_extra ? 0 : tree_numbers[r][k];
    PlanName& name = name_of[static_cast<std::size_t>(f.landmark)];
    name.landmark_id = l.id;
    name.row = plan.rows[r].name;
    if (!is_extra) name.tree = plan.rows[r].trees[k].name;
  }
  name_of.erase(std::remove_if(name_of.begin(), name_of.end(),
                               [](const PlanName& name) { return name.landmark_id == 0; }),
                name_of.end());
  return name_of;
}

}  // namespace orchard::mapping
