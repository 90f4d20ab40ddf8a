// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/row_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "geometry/point_grid.hpp"
#include "geometry/statistics.hpp"
#include "mapping/tuning.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

/// Sum and number of the distances to the right from one chain's trees to another chain.
struct Beside {
  double sum_m = 0.0;
  int count = 0;
};

/// Per pair of chains: distances from the trees of one to their nearest tree to the right, if that
/// is in the other.
std::map<std::pair<int, int>, Beside> neighbours_to_the_right(const std::vector<Vector2d>& p_map,
                                                              const RowDirections& rows,
                                                              const std::vector<int>& chain_of) {
  const double reach_m = 6.0 * rows.spacing_m;
  const geometry::IndexedPoints points(p_map);
  std::map<std::pair<int, int>, Beside> beside;
  for (std::size_t i = 0; i < p_map.size(); ++i) {
    if (chain_of[i] < 0) continue;
    const Vector2d u = rows.directions[i];
    double nearest_m = reach_m;
    int nearest_chain = -1;
    points.near(p_map[i], std::hypot(reach_m, rows.spacing_m), [&](std::int32_t j) {
      const auto k = static_cast<std::size_t>(j);
      if (chain_of[k] < 0 || chain_of[k] == chain_of[i]) return;
      const Vector2d d = p_map[k] - p_map[i];
      const double right_m = u.y() * d.x() - u.x() * d.y();
      if (right_m <= 0.0 || std::abs(u.dot(d)) > rows.spacing_m) return;
      if (right_m < nearest_m || (right_m == nearest_m && chain_of[k] < nearest_chain)) {
        nearest_m = right_m;
        nearest_chain = chain_of[k];
      }
    });
    if (nearest_chain < 0) continue;
    Beside& b = beside[{chain_of[i], nearest_chain}];
    b.sum_m += nearest_m;
    ++b.count;
  }
  return beside;
}

}  // namespace

void order_from_left(const std::vector<Vector2d>& p_map, const RowDirections& rows,
                     std::vector<RowChain>& chains) {
  std::vector<int> chain_of(p_map.size(), -1);
  Vector2d forward(0.0, 0.0);
  for (std::size_t c = 0; c < chains.size(); ++c) {
    for (const std::int32_t i : chains[c]) {
      chain_of[static_cast<std::size_t>(i)] = static_cast<int>(c);
      forward += rows.directions[static_cast<std::size_t>(i)];
    }
  }
  forward.normalize();
  const Vector2d right(forward.y(), -forward.x());

  std::vector<double> centre_m(chains.size(), 0.0);
  for (std::size_t c = 0; c < chains.size(); ++c) {
    for (const std::int32_t i : chains[c]) {
      centre_m[c] +=
          right.dot(p_map[static_cast<std::size_t>(i)]) / static_cast<double>(chains[c].size());
    }
  }
  std::vector<std::size_t> by_centre(chains.size());
  std::iota(by_centre.begin(), by_centre.end(), std::size_t{0});
  std::sort(by_centre.begin(), by_centre.end(), [&](std::size_t a, std::size_t b) {
    return std::make_pair(centre_m[a], a) < std::make_pair(centre_m[b], b);
  });

  std::vector<std::vector<std::pair<std::size_t, double>>> edges(chains.size());
  for (const auto& [pair, beside] : neighbours_to_the_right(p_map, rows, chain_of)) {
    // A single tree that sees past the end of a row is no adjacency.
    if (beside.count < 2) continue;
    const auto a = static_cast<std::size_t>(pair.first), b = static_cast<std::size_t>(pair.second);
    edges[a].push_back({b, beside.sum_m / beside.count});
    edges[b].push_back({a, -beside.sum_m / beside.count});
  }
  // Lateral coordinate of each row, accumulated from the leftmost row of its group.
  std::vector<double> across_m(chains.size(), 0.0);
  std::vector<bool> reached(chains.size(), false);
  for (const std::size_t start : by_centre) {
    if (reached[start]) continue;
    reached[start] = true;
    across_m[start] = centre_m[start];
    std::vector<std::size_t> queue{start};
    for (std::size_t k = 0; k < queue.size(); ++k) {
      for (const auto& [to, step_m] : edges[queue[k]]) {
        if (reached[to]) continue;
        reached[to] = true;
        across_m[to] = across_m[queue[k]] + step_m;
        queue.push_back(to);
      }
    }
  }
  std::vector<std::size_t> order(by_centre);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return across_m[a] < across_m[b]; });
  std::vector<RowChain> sorted;
  for (const std::size_t c : order) sorted.push_back(std::move(chains[c]));
  chains = std::move(sorted);
}

namespace {

/// Median of the single steps. Gaps only make steps longer, so a step from the lower third is
/// single unless two thirds of the slots are empty.
double single_step_m(std::vector<double> steps_m) {
  std::sort(steps_m.begin(), steps_m.end());
  const double typical_m = steps_m[steps_m.size() * 3 / 10];
  std::vector<double> single;
  for (const double step_m : steps_m) {
    if (step_m < 1.45 * typical_m) single.push_back(step_m);
  }
  return geometry::median(single);
}

/// Spacing around step k.
double local_spacing_m(const std::vector<double>& steps_m, std::size_t k) {
  const std::size_t first = k > tuning::kSpacingWindow ? k - tuning::kSpacingWindow : 0;
  const std::size_t last = std::min(steps_m.size(), k + tuning::kSpacingWindow + 1);
  return single_step_m({steps_m.begin() + static_cast<std::ptrdiff_t>(first),
                        steps_m.begin() + static_cast<std::ptrdiff_t>(last)});
}

std::vector<int> places_within(const std::vector<Vector2d>& p_map, const RowChain& chain) {
  std::vector<double> steps_m;
  for (std::size_t i = 1; i < chain.size(); ++i) {
    steps_m.push_back(
        (p_map[static_cast<std::size_t>(chain[i])] - p_map[static_cast<std::size_t>(chain[i - 1])])
            .norm());
  }
  std::vector<int> places{0};
  for (std::size_t k = 0; k < steps_m.size(); ++k) {
    const double spacings = steps_m[k] / local_spacing_m(steps_m, k);
    places.push_back(places.back() + std::max(1, static_cast<int>(std::lround(spacings))));
  }
  return places;
}

/// Slot coordinate of a point along a chain: fractional between two trees, extrapolated at the
/// ends; none if the chain is not beside the point.
std::optional<double> place_beside(const Vector2d& p, const Vector2d& along,
                                   const std::vector<Vector2d>& p_map, const RowChain& chain,
                                   const std::vector<int>& places) {
  std::vector<double> ahead_m;
  for (const std::int32_t i : chain) {
    ahead_m.push_back(along.dot(p_map[static_cast<std::size_t>(i)] - p));
  }
  if (chain.size() < 2) return std::nullopt;
  // First tree at or ahead of the point; the ends are extrapolated by a few slots at most.
  std::size_t k = 1;
  while (k + 1 < chain.size() && ahead_m[k] < 0.0) ++k;
  const double step_m = ahead_m[k] - ahead_m[k - 1];
  if (step_m <= 0.0) return std::nullopt;
  const double fraction = -ahead_m[k - 1] / step_m;
  const double place = places[k - 1] + fraction * (places[k] - places[k - 1]);
  if (place < -4.0 || place > places.back() + 1.0) return std::nullopt;
  return place;
}

/// Direction of a chain at its i-th tree: the chord between the neighbours.
Vector2d tangent(const std::vector<Vector2d>& p_map, const RowChain& chain, std::size_t i) {
  const std::size_t before = i == 0 ? 0 : i - 1;
  const std::size_t after = std::min(i + 1, chain.size() - 1);
  return (p_map[static_cast<std::size_t>(chain[after])] -
          p_map[static_cast<std::size_t>(chain[before])])
      .normalized();
}

/// Number of slots by which chain r starts later than chain q; none if they are not beside each
/// other.
std::optional<double> later_start(const std::vector<Vector2d>& p_map, const RowChain& q,
                                  const std::vector<int>& places_q, const RowChain& r,
                                  const std::vector<int>& places_r) {
  std::vector<double> offsets;
  for (std::size_t i = 0; i < std::min(tuning::kNumCompared, r.size()); ++i) {
    const auto place = place_beside(p_map[static_cast<std::size_t>(r[i])], tangent(p_map, r, i),
                                    p_map, q, places_q);
    if (place) offsets.push_back(*place - places_r[i]);
  }
  if (offsets.empty()) return std::nullopt;
  return geometry::median(offsets);
}

/// A headland: start of the rows as a linear function of the row index.
struct Headland {
  double start = 0.0;  ///< at row `row`
  double slope = 0.0;  ///< slots per row
  int row = 0;

  double at(int r) const { return start + slope * (r - row); }
};

/// Number of empty slots before a row that starts at `start`.
int places_late(double start, const Headland& line, int r) {
  return std::max(0, static_cast<int>(std::lround(start - line.at(r))));
}

/// Negative log likelihood of the starts of rows first..last if planted along the line: a first
/// tree is missing with probability 0.1, starts scatter by a fifth of a slot, and most headlands
/// are perpendicular to the rows.
double cost_of(const Headland& line, const std::vector<double>& starts, int first, int last) {
  double cost = std::abs(line.slope) > 0.05 ? tuning::kCostSlope : 0.0;
  for (int r = first; r <= last; ++r) {
    const double start = starts[static_cast<std::size_t>(r)];
    const int late = places_late(start, line, r);
    const double off = (start - line.at(r) - late) / tuning::kScatter;
    cost += std::min(tuning::kCostMax, tuning::kCostMissing * late + 0.5 * off * off);
  }
  return cost;
}

/// Number of empty slots at the start of a row, estimated from the rows around it.
int num_empty_before(const std::vector<double>& starts, int r) {
  const int first = std::max(0, r - tuning::kRowsAround);
  const int last = std::min(static_cast<int>(starts.size()) - 1, r + tuning::kRowsAround);
  const auto start = [&](int k) { return starts[static_cast<std::size_t>(k)]; };
  Headland best{start(r), 0.0, r};
  double least = cost_of(best, starts, first, last);
  for (int a = first; a <= last; ++a) {
    for (int b = a; b <= last; ++b) {  // a == b: perpendicular to the rows
      const Headland line{start(a), a == b ? 0.0 : (start(b) - start(a)) / (b - a), a};
      const double cost = cost_of(line, starts, first, last);
      if (cost < least) {
        least = cost;
        best = line;
      }
    }
  }
  return places_late(start(r), best, r);
}

}  // namespace

std::vector<std::vector<int>> slot_indices(const std::vector<Vector2d>& p_map,
                                           const std::vector<RowChain>& chains) {
  std::vector<std::vector<int>> positions;
  for (const RowChain& chain : chains) positions.push_back(places_within(p_map, chain));

  // Slot coordinate at which each row starts; rows of a group share one scale.
  std::vector<double> starts(chains.size(), 0.0);
  std::vector<int> group(chains.size(), 0);
  for (std::size_t r = 1; r < chains.size(); ++r) {
    const auto later = later_start(p_map, chains[r - 1], positions[r - 1], chains[r], positions[r]);
    group[r] = group[r - 1] + (later ? 0 : 1);
    starts[r] = later ? starts[r - 1] + *later : 0.0;
  }
  std::vector<int> shifts(chains.size(), 0);
  for (std::size_t begin = 0; begin < chains.size();) {
    std::size_t end = begin;
    while (end < chains.size() && group[end] == group[begin]) ++end;
    const std::vector<double> together(starts.begin() + static_cast<std::ptrdiff_t>(begin),
                                       starts.begin() + static_cast<std::ptrdiff_t>(end));
    for (std::size_t r = begin; r < end; ++r) {
      shifts[r] = num_empty_before(together, static_cast<int>(r - begin));
    }
    begin = end;
  }
  for (std::size_t r = 0; r < chains.size(); ++r) {
    for (int& position : positions[r]) position += shifts[r];
  }
  return positions;
}

namespace {

bool is_in_row(const Landmark& l) { return l.label == detection::Label::kTree && l.row > 0; }

/// Inserts a tree without a position between the two slots whose connection is nearest to it; at an
/// end if it lies beyond.
void insert_unnumbered(const RowSlot& tree, std::vector<RowSlot>& slots) {
  if (slots.size() < 2) return slots.push_back(tree);
  std::size_t best = 1;
  double least_m = std::numeric_limits<double>::max();
  for (std::size_t k = 1; k < slots.size(); ++k) {
    const double away_m = distance_to_segment_m(tree.p_map, slots[k - 1].p_map, slots[k].p_map);
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

void number_trunks_in_gaps(std::vector<Landmark>& landmarks) {
  std::vector<std::size_t> trunks;
  std::vector<Vector2d> places;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const Landmark& l = landmarks[i];
    if (l.label != detection::Label::kTree || l.position > 0) continue;
    trunks.push_back(i);
    places.push_back({l.x_m, l.y_m});
  }
  const geometry::IndexedPoints unnumbered(std::move(places));
  for (const Row& row : numbered_rows(landmarks)) {
    for (const RowSlot& slot : row.places) {
      if (slot.landmark_id != 0) continue;
      const double reach_m = tuning::kOnePlace_spacings * row.spacing_m;
      const std::int32_t nearest = unnumbered.nearest(slot.p_map, reach_m);
      if (nearest < 0) continue;
      Landmark& l = landmarks[trunks[static_cast<std::size_t>(nearest)]];
      if (l.position > 0) continue;  // taken by the slot before
      l.row = row.number;
      l.position = slot.position;
    }
  }
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
