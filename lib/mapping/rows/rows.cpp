// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/rows.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "geometry/angles.hpp"
#include "mapping/compare/landmark_pairing.hpp"
#include "mapping/rows/row_chains.hpp"
#include "mapping/rows/row_ends.hpp"
#include "mapping/rows/row_evidence.hpp"
#include "mapping/rows/row_members.hpp"
#include "mapping/rows/row_order.hpp"
#include "mapping/rows/row_slots.hpp"

namespace orchard::mapping {
namespace {

/// Minimum number of trees of a row: two are always in line.
constexpr int kRowTreesMin = 3;

/// Gaps longer than this, in tree spacings, end a row.
constexpr double kGapMax_spacings = 8.0;

using Eigen::Vector2d;

/// Chains at a larger angle to the rows (cosine of 60 degrees) are hedges or headlands.
constexpr double kAcross_cos = 0.5;

/// The trees sorted by position, so that the result does not depend on the order of the landmarks.
std::vector<const Landmark*> trees_of(const std::vector<Landmark>& landmarks) {
  std::vector<const Landmark*> trees;
  for (const Landmark& l : landmarks) {
    if (l.label == detection::Label::kTree) trees.push_back(&l);
  }
  std::sort(trees.begin(), trees.end(), [](const Landmark* a, const Landmark* b) {
    return std::make_pair(a->x_m, a->y_m) < std::make_pair(b->x_m, b->y_m);
  });
  return trees;
}

/// Direction of rising positions, consistent with the directions of all rows.
Vector2d forward_of(const std::vector<Vector2d>& directions, const RowsConfig& config) {
  Vector2d mean(0.0, 0.0);
  for (const Vector2d& u : directions) mean += u;
  if (config.numbering == RowNumbering::kDirection) {
    const double rad = config.forward_deg * geometry::kPi / 180.0;
    const Vector2d wanted(std::cos(rad), std::sin(rad));
    return mean.dot(wanted) < 0.0 ? Vector2d(-mean) : mean;
  }
  const double leading = std::abs(mean.y()) >= std::abs(mean.x()) ? mean.y() : mean.x();
  return leading < 0.0 ? Vector2d(-mean) : mean;
}

struct Lines {
  std::vector<Vector2d> p_map;
  RowDirections rows;
  std::vector<RowChain> chains;  ///< in lateral order, from the left
};

void turn_round(Lines& lines) {
  for (Vector2d& u : lines.rows.directions) u = -u;
  for (RowChain& chain : lines.chains) std::reverse(chain.begin(), chain.end());
  std::reverse(lines.chains.begin(), lines.chains.end());
}

/// Turns the numbering so that it starts at the corner nearest to the origin.
void begin_at_origin(Lines& lines, const Vector2d& origin) {
  const auto first = [&](const RowChain& chain) {
    return (lines.p_map[static_cast<std::size_t>(chain.front())] - origin).norm();
  };
  const auto last = [&](const RowChain& chain) {
    return (lines.p_map[static_cast<std::size_t>(chain.back())] - origin).norm();
  };
  const RowChain &left = lines.chains.front(), &right = lines.chains.back();
  if (std::min(last(left), last(right)) < std::min(first(left), first(right))) turn_round(lines);
  if (first(lines.chains.back()) < first(lines.chains.front())) {
    std::reverse(lines.chains.begin(), lines.chains.end());
  }
}

}  // namespace

std::vector<Row> find_rows(const std::vector<Landmark>& landmarks, const RowsConfig& config) {
  const std::vector<const Landmark*> all = trees_of(landmarks);
  std::vector<Vector2d> p_all;
  for (const Landmark* tree : all) p_all.push_back({tree->x_m, tree->y_m});
  const std::vector<double> strength_of_all = row_strengths(all);
  const SeedTrees chosen = seed_trees(p_all, strength_of_all);
  Lines lines;
  std::vector<const Landmark*> trees;
  std::vector<double> strengths;
  const auto take = [&](std::size_t i) {
    trees.push_back(all[i]);
    lines.p_map.push_back(p_all[i]);
    strengths.push_back(strength_of_all[i]);
  };
  for (const std::size_t i : chosen.seeds) take(i);
  lines.rows = row_directions(lines.p_map);
  if (lines.rows.directions.empty()) return {};
  if (forward_of(lines.rows.directions, config).dot(lines.rows.directions.front()) < 0.0) {
    for (Vector2d& u : lines.rows.directions) u = -u;
  }
  lines.chains = row_chains(lines.p_map, lines.rows, kGapMax_spacings);
  bridge_chain_gaps(lines.p_map, lines.rows, lines.chains);
  const IndexedPoints seeds(lines.p_map);
  std::vector<std::size_t> rest;
  for (const std::size_t i : chosen.rest) {
    const std::int32_t k = seeds.nearest(p_all[i], 1.5 * lines.rows.spacing_m);
    if (k < 0) continue;
    rest.push_back(trees.size());
    take(i);
    lines.rows.directions.push_back(lines.rows.directions[static_cast<std::size_t>(k)]);
  }
  join_weak_trees(lines.p_map, lines.rows, rest, lines.chains);
  for (RowChain& chain : lines.chains) chain = select_trees_in_slots(lines.p_map, strengths, chain);
  const Vector2d forward = forward_of(lines.rows.directions, config).normalized();
  const auto is_no_row = [&](const RowChain& chain) {
    if (chain.size() < static_cast<std::size_t>(kRowTreesMin)) return true;
    const Vector2d chord = lines.p_map[static_cast<std::size_t>(chain.back())] -
                           lines.p_map[static_cast<std::size_t>(chain.front())];
    return chord.dot(forward) < kAcross_cos * chord.norm();
  };
  lines.chains.erase(std::remove_if(lines.chains.begin(), lines.chains.end(), is_no_row),
                     lines.chains.end());
  drop_irregular_chains(lines.p_map, lines.chains);
  if (lines.chains.empty()) return {};
  trim_row_ends(lines.p_map, lines.rows.spacing_m, lines.chains);
  order_from_left(lines.p_map, lines.rows, lines.chains);
  if (config.numbering == RowNumbering::kOrigin) {
    begin_at_origin(lines, {config.origin_m[0], config.origin_m[1]});
  }

  const std::vector<std::vector<int>> positions = slot_indices(lines.p_map, lines.chains);
  std::vector<Row> rows;
  for (std::size_t r = 0; r < lines.chains.size(); ++r) {
    Row row;
    row.number = config.first_row + static_cast<int>(r);
    row.spacing_m = slot_spacing_m(lines.p_map, lines.chains[r], positions[r]);
    for (std::size_t i = 0; i < lines.chains[r].size(); ++i) {
      const auto tree = static_cast<std::size_t>(lines.chains[r][i]);
      const Vector2d& p = lines.p_map[tree];
      if (i > 0) {  // interpolate the empty slots between
        const RowSlot before = row.places.back();
        const int num_steps = positions[r][i] - positions[r][i - 1];
        for (int k = 1; k < num_steps; ++k) {
          row.places.push_back(
              {before.position + k, 0, before.p_map + (p - before.p_map) * k / num_steps});
        }
      }
      row.places.push_back({config.first_position + positions[r][i], trees[tree]->id, p});
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

void number_landmarks(const std::vector<Row>& rows, std::vector<Landmark>& landmarks) {
  std::map<std::int32_t, std::pair<std::int32_t, std::int32_t>> numbers;
  for (const Row& row : rows) {
    for (const RowSlot& place : row.places) {
      if (place.landmark_id != 0) numbers[place.landmark_id] = {row.number, place.position};
    }
  }
  for (Landmark& l : landmarks) {
    const auto found = numbers.find(l.id);
    const auto number = found == numbers.end() ? std::make_pair(0, 0) : found->second;
    l.row = number.first;
    l.position = number.second;
  }
}

}  // namespace orchard::mapping
