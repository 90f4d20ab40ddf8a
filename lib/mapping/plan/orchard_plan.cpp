// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/plan/orchard_plan.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "geometry/point_grid.hpp"
#include "geometry/statistics.hpp"
#include "geometry/symmetric.hpp"
#include "mapping/rows/rows.hpp"
#include "text/number_text.hpp"

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

double typical_aisle_m(const OrchardPlan& plan) {
  // derived: no orchard is planted wider; a sample of positions gives the median.
  constexpr double kWidestAisle_m = 30.0;
  constexpr std::size_t kNumAsked = 2000;
  const std::vector<PlanIndex> indices = plan_indices(plan);
  const geometry::IndexedPoints places(plan.places());
  const std::size_t step = std::max<std::size_t>(1, places.size() / kNumAsked);
  std::vector<double> aisles_m;
  for (std::size_t i = 0; i < places.size(); i += step) {
    // Expanding search radius: rows are near, and a wide search is expensive.
    for (double reach_m = 4.0; reach_m < 2.0 * kWidestAisle_m; reach_m *= 2.0) {
      double nearest_m = 1e300;
      for (const std::int32_t j : places.within(places[i], reach_m)) {
        if (indices[static_cast<std::size_t>(j)].row == indices[i].row) continue;
        nearest_m = std::min(nearest_m, (places[static_cast<std::size_t>(j)] - places[i]).norm());
      }
      if (nearest_m > reach_m) continue;
      aisles_m.push_back(nearest_m);
      break;
    }
  }
  return geometry::median(std::move(aisles_m));
}

namespace {

constexpr double kOnePlace_m = 0.1;         ///< derived: half of the closest planting
constexpr std::size_t kNumProblemsMax = 8;  ///< derived: max number of reported problems

Vector2d main_direction(const std::vector<PlannedTree>& trees) {
  Vector2d mean(0.0, 0.0);
  for (const PlannedTree& t : trees) mean += t.p_plan / static_cast<double>(trees.size());
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const PlannedTree& t : trees) {
    spread += (t.p_plan - mean) * (t.p_plan - mean).transpose();
  }
  return geometry::axes_of(spread).directions.col(1);
}

void sort_along(PlannedRow& row) {
  auto& trees = row.trees;
  if (std::all_of(trees.begin(), trees.end(),
                  [](const PlannedTree& t) { return number_in_name(t.name) > 0; })) {
    std::stable_sort(trees.begin(), trees.end(), [](const PlannedTree& a, const PlannedTree& b) {
      return number_in_name(a.name) < number_in_name(b.name);
    });
    return;
  }
  if (trees.size() < 2) return;
  Vector2d along = main_direction(trees);
  // The first trees in the file are at the start of the row.
  double sum_first = 0.0, sum_last = 0.0;
  for (std::size_t k = 0; k < trees.size() / 2; ++k) {
    sum_first += along.dot(trees[k].p_plan);
    sum_last += along.dot(trees[trees.size() - 1 - k].p_plan);
  }
  if (sum_first > sum_last) along = -along;
  std::stable_sort(trees.begin(), trees.end(), [&](const PlannedTree& a, const PlannedTree& b) {
    return along.dot(a.p_plan) < along.dot(b.p_plan);
  });
}

void number_unnamed(PlannedRow& row) {
  if (std::any_of(row.trees.begin(), row.trees.end(),
                  [](const PlannedTree& t) { return !t.name.empty(); })) {
    return;
  }
  for (std::size_t k = 0; k < row.trees.size(); ++k) row.trees[k].name = std::to_string(k + 1);
}

void add_problem(BuiltPlan& built, std::string problem) {
  if (built.problems.size() < kNumProblemsMax) built.problems.push_back(std::move(problem));
}

/// A name as its characters, each whole number as one: '0' with its value.
std::vector<std::pair<char, double>> name_parts(const std::string& name) {
  std::vector<std::pair<char, double>> parts;
  bool is_in_number = false;
  for (const char c : name) {
    const bool is_digit = c >= '0' && c <= '9';
    if (!is_digit) parts.emplace_back(c, 0.0);
    if (is_digit && !is_in_number) parts.emplace_back('0', 0.0);
    if (is_digit) parts.back().second = 10.0 * parts.back().second + (c - '0');
    is_in_number = is_digit;
  }
  return parts;
}

void sort_rows(OrchardPlan& plan) {
  std::stable_sort(plan.rows.begin(), plan.rows.end(), [](const auto& a, const auto& b) {
    return name_parts(a.name) < name_parts(b.name);
  });
}

void look_for_doubles(BuiltPlan& built) {
  for (const PlannedRow& row : built.plan.rows) {
    std::set<std::string> names;
    for (const PlannedTree& tree : row.trees) {
      if (tree.name.empty()) {
        add_problem(built, "row " + row.name + " has trees with and without a name");
        break;
      }
      if (!names.insert(tree.name).second) {
        add_problem(built, "row " + row.name + " has two trees " + tree.name);
      }
    }
  }
  const std::vector<PlanIndex> indices = plan_indices(built.plan);
  const geometry::IndexedPoints places(built.plan.places());
  const auto name_of = [&](std::size_t i) {
    const PlannedRow& row = built.plan.rows[static_cast<std::size_t>(indices[i].row)];
    return row.name + "/" + row.trees[static_cast<std::size_t>(indices[i].tree)].name;
  };
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (const std::int32_t j : places.within(places[i], kOnePlace_m)) {
      if (static_cast<std::size_t>(j) <= i) continue;
      add_problem(built, "trees " + name_of(i) + " and " + name_of(static_cast<std::size_t>(j)) +
                             " have the same position");
    }
  }
}

/// Finds rows as in a map of these trees, because the file names none.
std::vector<PlannedRow> rows_found(const std::vector<LoosePlannedTree>& trees, BuiltPlan& built) {
  std::vector<Landmark> landmarks;
  for (std::size_t i = 0; i < trees.size(); ++i) {
    Landmark l;
    l.id = static_cast<std::int32_t>(i) + 1;
    l.label = detection::Label::kTree;
    l.num_observations = 1;
    l.x_m = trees[i].p_plan.x();
    l.y_m = trees[i].p_plan.y();
    l.width_m = 0.1;
    l.roc_mean = l.probability = 1.0;
    landmarks.push_back(l);
  }
  const std::vector<Row> rows = find_rows(landmarks, RowsConfig{});
  std::vector<PlannedRow> planned;
  std::size_t num_in_rows = 0;
  for (const Row& row : rows) {
    PlannedRow& r = planned.emplace_back();
    r.name = std::to_string(row.number);
    for (const RowSlot& place : row.places) {
      if (place.landmark_id == 0) continue;
      const LoosePlannedTree& tree = trees[static_cast<std::size_t>(place.landmark_id) - 1];
      r.trees.push_back({std::to_string(place.position), tree.p_plan});
      ++num_in_rows;
    }
  }
  built.notes.push_back("the plan does not name rows: " + std::to_string(planned.size()) +
                        " rows were found from the positions of the trees and numbered");
  if (num_in_rows < trees.size()) {
    built.notes.push_back(std::to_string(trees.size() - num_in_rows) +
                          " trees of the plan are in no row and are left out");
  }
  if (planned.empty()) {
    built.problems.push_back("no rows of trees were found; name the row of each tree in a column");
  }
  return planned;
}

}  // namespace

std::int32_t number_in_name(const std::string& name) {
  if (name.empty() || name.size() > 9) return 0;
  std::int32_t number = 0;
  for (const char c : name) {
    if (c < '0' || c > '9') return 0;
    number = 10 * number + (c - '0');
  }
  return number;
}

BuiltPlan plan_of_trees(const std::vector<LoosePlannedTree>& trees) {
  BuiltPlan built;
  const auto num_named = static_cast<std::size_t>(std::count_if(
      trees.begin(), trees.end(), [](const LoosePlannedTree& t) { return !t.row.empty(); }));
  if (num_named == 0) {
    built.plan.rows = rows_found(trees, built);
  } else {
    if (num_named < trees.size()) {
      built.problems.push_back(std::to_string(trees.size() - num_named) + " of " +
                               std::to_string(trees.size()) + " trees have no row");
    }
    std::map<std::string, std::size_t> row_of_name;
    for (const LoosePlannedTree& tree : trees) {
      if (tree.row.empty()) continue;
      const auto [at, is_new] = row_of_name.try_emplace(tree.row, built.plan.rows.size());
      if (is_new) built.plan.rows.push_back({tree.row, {}});
      built.plan.rows[at->second].trees.push_back({tree.tree, tree.p_plan});
    }
    for (PlannedRow& row : built.plan.rows) {
      sort_along(row);
      number_unnamed(row);
    }
    sort_rows(built.plan);
  }
  look_for_doubles(built);
  return built;
}

BuiltPlan plan_of_lines(const std::vector<PlannedLine>& lines, double spacing_m) {
  // derived: bounds the memory when the spacing is nearly 0.
  constexpr std::size_t kNumTreesMax = 2000000;
  BuiltPlan built;
  std::set<std::string> names;
  const bool is_named = std::any_of(lines.begin(), lines.end(),
                                    [](const PlannedLine& line) { return !line.row.empty(); });
  std::size_t num_trees = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    PlannedRow row{is_named ? lines[i].row : std::to_string(i + 1), {}};
    if (row.name.empty()) {
      add_problem(built, "row line " + std::to_string(i + 1) + " has no name, but others have one");
    } else if (!names.insert(row.name).second) {
      add_problem(built, "two lines have the name of row " + row.name);
    }
    double next_m = 0.0;  // from the start of the segment to the next tree
    const auto& points = lines[i].points;
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
      const double length_m = (points[k + 1] - points[k]).norm();
      // Tolerance for a tree at the end of the line.
      const double hair_m = k + 2 == points.size() ? 0.02 * spacing_m : 0.0;
      for (; next_m <= length_m + hair_m && num_trees < kNumTreesMax; next_m += spacing_m) {
        const Vector2d step = (points[k + 1] - points[k]).stableNormalized();
        row.trees.push_back({std::to_string(row.trees.size() + 1), points[k] + next_m * step});
        ++num_trees;
      }
      next_m -= length_m;
    }
    if (row.trees.empty()) {
      add_problem(built, "row " + row.name + " is not a line");
      continue;
    }
    built.plan.rows.push_back(std::move(row));
  }
  sort_rows(built.plan);
  if (num_trees >= kNumTreesMax) {
    add_problem(built, "trees every " + fixed_text(spacing_m, 3) + " m apart would be more than " +
                           std::to_string(kNumTreesMax));
    return built;
  }
  look_for_doubles(built);
  return built;
}

}  // namespace orchard::mapping
