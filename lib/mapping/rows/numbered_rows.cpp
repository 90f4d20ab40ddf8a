// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/numbered_rows.hpp"

#include <algorithm>
#include <limits>
#include <map>

#include "geometry/statistics.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

bool is_in_row(const Landmark& l) { return l.label == detection::Label::kTree && l.row > 0; }

double distance_m(const Vector2d& p, const Vector2d& from, const Vector2d& to) {
  const Vector2d along = to - from;
  const double square = along.squaredNorm();
  const double fraction = square > 0.0 ? std::clamp(along.dot(p - from) / square, 0.0, 1.0) : 0.0;
  return (from + fraction * along - p).norm();
}

/// Inserts a tree without a position between the two slots whose connection is nearest to it; at an
/// end if it lies beyond.
void insert_unnumbered(const RowSlot& tree, std::vector<RowSlot>& slots) {
  if (slots.size() < 2) return slots.push_back(tree);
  std::size_t best = 1;
  double least_m = std::numeric_limits<double>::max();
  for (std::size_t k = 1; k < slots.size(); ++k) {
    const double away_m = distance_m(tree.p_map, slots[k - 1].p_map, slots[k].p_map);
    if (away_m < least_m) least_m = away_m, best = k;
  }
  const auto is_beyond = [&](std::size_t end, std::size_t inner) {
    return (slots[inner].p_map - slots[end].p_map).dot(tree.p_map - slots[end].p_map) < 0.0;
  };
  if (best == 1 && is_beyond(0, 1)) best = 0;
  if (best + 1 == slots.size() && is_beyond(slots.size() - 1, slots.size() - 2)) ++best;
  slots.insert(slots.begin() + static_cast<std::ptrdiff_t>(best), tree);
}

Row row_of(std::int32_t number, const std::vector<const Landmark*>& trees) {
  Row row;
  row.number = number;
  std::vector<double> spacings_m;
  int num_left = kSlotsMax;
  for (const Landmark* tree : trees) {
    const Vector2d p(tree->x_m, tree->y_m);
    if (!row.places.empty()) {
      const RowSlot before = row.places.back();
      const std::int32_t num_steps = tree->position - before.position;
      for (std::int32_t k = 1; k < num_steps && num_left > 0; ++k, --num_left) {
        row.places.push_back(
            {before.position + k, 0, before.p_map + (p - before.p_map) * k / num_steps});
      }
      if (num_steps > 0) spacings_m.push_back((p - before.p_map).norm() / num_steps);
    }
    row.places.push_back({tree->position, tree->id, p});
  }
  if (!spacings_m.empty()) row.spacing_m = geometry::median(std::move(spacings_m));
  return row;
}

/// A slot near a tree, and how far away.
struct NearSlot {
  double away_m = std::numeric_limits<double>::max();
  std::int32_t row = 0, position = 0;
};

/// The nearest slot of a row, within half of its spacing; also those that continue the row: each is
/// the mirror image, in the row's last tree, of a slot before it.
void look_in(const Row& row, const Vector2d& p, NearSlot& best) {
  const auto look_at = [&](const Vector2d& p_slot, std::int32_t position) {
    const double away_m = (p_slot - p).norm();
    if (away_m > 0.5 * row.spacing_m || away_m >= best.away_m) return;
    best = {away_m, row.number, position};
  };
  std::vector<RowSlot> slots = row.places;
  slots.erase(std::remove_if(slots.begin(), slots.end(),
                             [](const RowSlot& slot) { return slot.position == 0; }),
              slots.end());
  if (slots.empty()) return;
  const RowSlot &first = slots.front(), &last = slots.back();
  for (const RowSlot& slot : slots) {
    look_at(slot.p_map, slot.landmark_id == 0 ? slot.position : 0);
    if (&slot != &last && last.position - slot.position <= kGapMax_slots) {
      look_at(2.0 * last.p_map - slot.p_map, 2 * last.position - slot.position);
    }
    const std::int32_t before = 2 * first.position - slot.position;
    const bool is_near_first = slot.position - first.position <= kGapMax_slots;
    if (&slot != &first && is_near_first && before > 0) {
      look_at(2.0 * first.p_map - slot.p_map, before);
    }
  }
}

}  // namespace

std::vector<Row> numbered_rows(const std::vector<Landmark>& landmarks) {
  std::map<std::int32_t, std::vector<const Landmark*>> trees_of_row, unnumbered_of_row;
  for (const Landmark& l : landmarks) {
    if (is_in_row(l)) (l.position > 0 ? trees_of_row : unnumbered_of_row)[l.row].push_back(&l);
  }
  for (const auto& [number, trees] : unnumbered_of_row) trees_of_row[number];
  std::vector<Row> rows;
  for (auto& [number, trees] : trees_of_row) {
    std::stable_sort(trees.begin(), trees.end(), [](const Landmark* a, const Landmark* b) {
      return a->position < b->position;
    });
    rows.push_back(row_of(number, trees));
    const auto unnumbered = unnumbered_of_row.find(number);
    if (unnumbered == unnumbered_of_row.end()) continue;
    for (const Landmark* tree : unnumbered->second) {
      insert_unnumbered({0, tree->id, {tree->x_m, tree->y_m}}, rows.back().places);
    }
  }
  return rows;
}

void number_added_trees(std::vector<Landmark>& landmarks,
                        const std::function<bool(const Landmark&)>& is_added) {
  std::vector<Row> rows = numbered_rows(landmarks);
  for (Landmark& l : landmarks) {
    if (l.label != detection::Label::kTree || l.row != 0 || !is_added(l)) continue;
    NearSlot best;
    for (const Row& row : rows) look_in(row, {l.x_m, l.y_m}, best);
    if (best.row == 0) continue;
    l.row = best.row;
    l.position = best.position;
    std::vector<Landmark> trees;
    for (const Landmark& other : landmarks) {
      if (other.row == l.row) trees.push_back(other);
    }
    const auto row =
        std::find_if(rows.begin(), rows.end(), [&](const Row& r) { return r.number == l.row; });
    *row = numbered_rows(trees).front();
  }
}

}  // namespace orchard::mapping
