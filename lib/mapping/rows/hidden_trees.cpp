// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/hidden_trees.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/angles.hpp"
#include "geometry/point_grid.hpp"
#include "geometry/statistics.hpp"
#include "mapping/rows/row_numbers.hpp"
#include "mapping/rows/rows.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

/// derived: one in ten may be wrong.
constexpr double kSureTree = 0.9;
/// derived: the share changes by less than a hundredth after so many rounds.
constexpr int kShareRounds = 20;
/// derived: what stands around a slot is counted as far as the slots after the next ones.
constexpr double kAround_spacings = 2.0;

/// From one place to another, along and across the line through two neighbours [m].
Vector2d along_and_across_m(const Vector2d& before, const Vector2d& after, const Vector2d& away_m) {
  const Vector2d along = (after - before).normalized();
  return {along.dot(away_m), along.x() * away_m.y() - along.y() * away_m.x()};
}

/// How far the trees of the rows stand beside the middle between their neighbours: means of
/// exponential distributions, in spacings. 0 without such trees.
struct Placing {
  double along_spacings = 0.0, across_spacings = 0.0;

  explicit Placing(const std::vector<Row>& rows) {
    std::vector<double> along, across;
    for (const Row& row : rows) {
      for (std::size_t i = 1; i + 1 < row.places.size(); ++i) {
        const RowSlot &before = row.places[i - 1], &here = row.places[i],
                      &after = row.places[i + 1];
        if (before.landmark_id == 0 || here.landmark_id == 0 || after.landmark_id == 0) continue;
        const Vector2d middle = 0.5 * (before.p_map + after.p_map);
        const Vector2d beside_m =
            along_and_across_m(before.p_map, after.p_map, here.p_map - middle);
        along.push_back(std::abs(beside_m.x()) / row.spacing_m);
        across.push_back(std::abs(beside_m.y()) / row.spacing_m);
      }
    }
    along_spacings = geometry::median(std::move(along)) / std::log(2.0);
    across_spacings = geometry::median(std::move(across)) / std::log(2.0);
  }

  bool is_known() const { return along_spacings > 0.0 && across_spacings > 0.0; }

  /// Density of a row's trees beside their slot [1/m2].
  double density(const Vector2d& beside_m, double spacing_m) const {
    const double along_m = along_spacings * spacing_m, across_m = across_spacings * spacing_m;
    return std::exp(-std::abs(beside_m.x()) / along_m - std::abs(beside_m.y()) / across_m) /
           (4.0 * along_m * across_m);
  }
};

/// What may be the tree of an empty slot.
struct Gap {
  std::int32_t row = 0, position = 0;
  std::size_t landmark = 0;
  double odds = 0.0;  ///< that its tree stands so over that anything does; 0: nothing is near
};

/// Median width of the trees in the rows [m].
double row_width_m(const std::vector<Landmark>& landmarks) {
  std::vector<double> widths_m;
  for (const Landmark& l : landmarks) {
    if (l.row > 0) widths_m.push_back(l.width_m);
  }
  return geometry::median(std::move(widths_m));
}

std::vector<Gap> gaps_of(const std::vector<Row>& rows, const std::vector<Landmark>& landmarks) {
  const Placing placing(rows);
  if (!placing.is_known()) return {};
  const double width_min_m = row_width_m(landmarks);
  std::vector<std::size_t> objects;
  std::vector<Vector2d> p_objects;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const Landmark& l = landmarks[i];
    if (l.label != detection::Label::kObject || l.length_m > 0.0) continue;
    objects.push_back(i);
    p_objects.push_back({l.x_m, l.y_m});
  }
  const geometry::IndexedPoints around(std::move(p_objects));
  std::vector<Gap> gaps;
  for (const Row& row : rows) {
    const double reach_m = kAround_spacings * row.spacing_m;
    for (std::size_t i = 1; i + 1 < row.places.size(); ++i) {
      const RowSlot& slot = row.places[i];
      if (slot.landmark_id != 0) continue;
      Gap& gap = gaps.emplace_back(Gap{row.number, slot.position, 0, 0.0});
      const auto near = around.within(slot.p_map, reach_m);
      const double density_by_chance =
          static_cast<double>(near.size()) / (geometry::kPi * reach_m * reach_m);
      for (const std::int32_t k : near) {
        const std::size_t landmark = objects[static_cast<std::size_t>(k)];
        if (landmarks[landmark].width_m < width_min_m) continue;
        const Vector2d beside_m =
            along_and_across_m(row.places[i - 1].p_map, row.places[i + 1].p_map,
                               around[static_cast<std::size_t>(k)] - slot.p_map);
        const double odds = placing.density(beside_m, row.spacing_m) / density_by_chance;
        if (odds > gap.odds) gap.landmark = landmark, gap.odds = odds;
      }
    }
  }
  return gaps;
}

/// Odds that an empty slot hides its tree, from all of them; one more of either kind is assumed.
double odds_of_hiding(const std::vector<Gap>& gaps) {
  double odds = 1.0;
  for (int round = 0; round < kShareRounds; ++round) {
    double num_hidden = 1.0;
    for (const Gap& gap : gaps) num_hidden += 1.0 - 1.0 / (1.0 + odds * gap.odds);
    odds = num_hidden / (static_cast<double>(gaps.size()) + 2.0 - num_hidden);
  }
  return odds;
}

}  // namespace

std::vector<std::int32_t> name_trees_in_gaps(std::vector<Landmark>& landmarks) {
  std::vector<Gap> gaps = gaps_of(numbered_rows(landmarks), landmarks);
  const double odds = odds_of_hiding(gaps);
  std::vector<std::int32_t> named;
  std::stable_sort(gaps.begin(), gaps.end(),
                   [](const Gap& a, const Gap& b) { return a.odds > b.odds; });
  for (const Gap& gap : gaps) {
    if (odds * gap.odds < kSureTree / (1.0 - kSureTree)) break;
    Landmark& l = landmarks[gap.landmark];
    if (l.row > 0) continue;  // the tree of a slot where it stands better
    l.label = detection::Label::kTree;
    l.row = gap.row;
    l.position = gap.position;
    named.push_back(l.id);
  }
  std::sort(named.begin(), named.end());
  return named;
}

}  // namespace orchard::mapping
