// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/compare/number_keeping.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "mapping/compare/local_deformation.hpp"
#include "mapping/compare/map_comparison.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;
using Number = std::pair<std::int32_t, std::int32_t>;  ///< row, position

/// Number of the earlier row with most known trees of this row; 0 without any.
std::int32_t known_row(const Row& row, const std::map<std::int32_t, Number>& numbers) {
  std::map<std::int32_t, int> votes;
  for (const RowSlot& place : row.places) {
    const auto found = numbers.find(place.landmark_id);
    if (place.landmark_id != 0 && found != numbers.end()) ++votes[found->second.first];
  }
  std::int32_t best = 0;
  int most = 0;
  for (const auto& [number, count] : votes) {
    if (count > most) best = number, most = count;
  }
  return best;
}

/// Reverses a row if the positions of its known trees decrease along it.
void turn_as_known(Row& row, const std::map<std::int32_t, Number>& numbers) {
  int rising = 0;
  std::int32_t last = 0;
  for (const RowSlot& place : row.places) {
    const auto found = numbers.find(place.landmark_id);
    if (place.landmark_id == 0 || found == numbers.end() || found->second.second == 0) continue;
    if (last != 0) rising += found->second.second > last ? 1 : -1;
    last = found->second.second;
  }
  if (rising >= 0) return;
  std::reverse(row.places.begin(), row.places.end());
  for (RowSlot& place : row.places) place.position = -place.position;
}

/// Positions of a row's slots, counted from its known trees; 0 where no number is free.
std::vector<std::int32_t> kept_positions(const Row& row, std::int32_t number,
                                         const std::map<std::int32_t, Number>& numbers,
                                         const std::set<Number>& taken) {
  const std::size_t num = row.places.size();
  std::vector<std::int32_t> positions(num, 0);
  std::vector<std::size_t> known;
  for (std::size_t i = 0; i < num; ++i) {
    const auto found = numbers.find(row.places[i].landmark_id);
    if (row.places[i].landmark_id == 0 || found == numbers.end()) continue;
    if (found->second.first != number || found->second.second == 0) continue;
    positions[i] = found->second.second;
    known.push_back(i);
  }
  for (std::size_t i = 0; i < num; ++i) {
    if (positions[i] != 0) continue;
    const auto after = std::upper_bound(known.begin(), known.end(), i);
    const bool has_after = after != known.end(), has_before = after != known.begin();
    std::int32_t position = 0;
    const auto from = [&](std::size_t k) {
      return positions[k] + (row.places[i].position - row.places[k].position);
    };
    if (has_before) position = from(*(after - 1));
    if (!has_before && has_after) position = from(*after);
    const std::int32_t lowest = has_before ? positions[*(after - 1)] : 0;
    const bool is_between = position > lowest && (!has_after || position < positions[*after]);
    if (is_between && position >= 1 && taken.count({number, position}) == 0) {
      positions[i] = position;
    }
  }
  return positions;
}

}  // namespace

IdTransfer keep_ids(const std::vector<Landmark>& earlier, const MapAlignment& alignment,
                    std::int32_t& next_id, std::vector<Landmark>& landmarks) {
  std::vector<std::int32_t> kept_id(landmarks.size(), 0);
  std::vector<bool> is_found(earlier.size(), false);
  IdTransfer kept;
  const auto keep = [&](std::int32_t of_earlier, std::int32_t of_now) {
    kept_id[static_cast<std::size_t>(of_now)] = earlier[static_cast<std::size_t>(of_earlier)].id;
    is_found[static_cast<std::size_t>(of_earlier)] = true;
    ++kept.num_found;
  };
  const geometry::IndexedPoints then(landmark_positions(earlier)),
      now(landmark_positions(landmarks));
  const geometry::IndexedPoints laid(without_local_deformation(then, now, alignment));
  const double gate_m = std::clamp(0.35 * geometry::typical_spacing_m(then), 0.1, 0.5);
  // Trees: use the pairs of compare_maps(), which recognises a tree planted beside a missing one.
  // Pairs farther apart than gate_m may be moved trees, but are too uncertain.
  ComparisonConfig everywhere;
  everywhere.assume_seen = true;
  for (const MapChange& c :
       compare_maps(earlier, landmarks, DetectionMap(), DetectionMap(), alignment, everywhere)
           .changes) {
    if (c.a >= 0 && c.b >= 0 && c.moved_m <= gate_m) keep(c.a, c.b);
  }
  for (const LandmarkPair& pair : pair_landmarks(then, laid, geometry::Pose2{}, gate_m)) {
    const auto i = static_cast<std::size_t>(pair.a), j = static_cast<std::size_t>(pair.b);
    const bool are_objects = earlier[i].label == detection::Label::kObject &&
                             landmarks[j].label == detection::Label::kObject;
    if (are_objects && !is_found[i] && kept_id[j] == 0) keep(pair.a, pair.b);
  }
  kept.num_gone = static_cast<int>(earlier.size()) - kept.num_found;
  kept.num_new = static_cast<int>(landmarks.size()) - kept.num_found;
  for (const Landmark& l : earlier) next_id = std::max(next_id, l.id + 1);
  for (std::size_t j = 0; j < landmarks.size(); ++j) {
    landmarks[j].id = kept_id[j] != 0 ? kept_id[j] : next_id++;
  }
  std::sort(landmarks.begin(), landmarks.end(),
            [](const Landmark& x, const Landmark& y) { return x.id < y.id; });
  return kept;
}

void keep_numbers(const std::vector<Landmark>& earlier, std::vector<Row> rows,
                  std::vector<Landmark>& landmarks, IdTransfer& kept) {
  std::set<std::int32_t> present;
  for (const Landmark& l : landmarks) present.insert(l.id);
  std::map<std::int32_t, Number> numbers;
  std::set<Number> taken;  ///< of trees that still exist
  std::int32_t next_row = 1;
  for (const Landmark& l : earlier) {
    next_row = std::max(next_row, l.row + 1);
    if (l.row == 0 || present.count(l.id) == 0) continue;
    numbers[l.id] = {l.row, l.position};
    if (l.position != 0) taken.insert({l.row, l.position});
  }
  std::map<std::int32_t, Number> given = numbers;
  for (Row& row : rows) {
    std::int32_t number = known_row(row, numbers);
    const bool is_known = number != 0;
    if (is_known) {
      turn_as_known(row, numbers);
    } else {
      number = next_row++;
    }
    const std::vector<std::int32_t> positions =
        is_known ? kept_positions(row, number, numbers, taken) : std::vector<std::int32_t>();
    for (std::size_t i = 0; i < row.places.size(); ++i) {
      const RowSlot& place = row.places[i];
      const std::int32_t position = is_known ? positions[i] : place.position;
      if (place.landmark_id != 0 && numbers.count(place.landmark_id) == 0) {
        given[place.landmark_id] = {number, position};
        kept.num_without_number += position == 0;
      }
      if (position != 0) taken.insert({number, position});
    }
  }
  for (Landmark& l : landmarks) {
    const auto found = given.find(l.id);
    const Number number = found == given.end() ? Number{0, 0} : found->second;
    l.row = number.first;
    l.position = number.second;
  }
}

}  // namespace orchard::mapping
