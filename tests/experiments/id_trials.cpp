// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <set>

#include "experiments/changed_block.hpp"
#include "experiments/two_map_trials.hpp"
#include "mapping/compare/number_keeping.hpp"

namespace orchard::trials {
namespace {

struct Kept {
  int num_pairs = 0;    ///< trees that stand in both maps where they stood
  int num_ids = 0;      ///< of them with another id
  int num_numbers = 0;  ///< with another row or position
  int num_reused = 0;   ///< new trees with an id that was another's
  int num_twice = 0;    ///< numbers that two trees have
  int num_unaligned = 0;
  bool is_whole() const {
    return num_ids + num_numbers + num_reused + num_twice + num_unaligned == 0;
  }
  void add(const Kept& o) {
    num_pairs += o.num_pairs, num_ids += o.num_ids, num_numbers += o.num_numbers;
    num_reused += o.num_reused, num_twice += o.num_twice, num_unaligned += o.num_unaligned;
  }
};

struct Known {
  std::int32_t id = 0;
  std::pair<std::int32_t, std::int32_t> number;
};

Kept map_again(std::uint64_t seed) {
  Kept kept;
  Dice dice(seed);
  Block block = plant_block(dice, 10, 30);
  DrivenMap a = drive_through(block, Drive{}, dice);
  std::vector<Row> rows = find_rows(a.landmarks, RowsConfig{});
  number_landmarks(rows, a.landmarks);
  std::map<int, Known> known;
  std::set<std::int32_t> ids;
  for (std::size_t i = 0; i < a.landmarks.size(); ++i) {
    const Landmark& l = a.landmarks[i];
    known[a.tree_of[i]] = {l.id, {l.row, l.position}};
    ids.insert(l.id);
  }
  const std::map<int, Change> truth = change_block(block, DayChanges{}, dice);
  Drive later;
  later.T_map_block = {dice.uniform(-2, 2), dice.uniform(-2, 2), dice.uniform(-0.05, 0.05)};
  DrivenMap b = drive_through(block, later, dice);
  const MapAlignment alignment =
      align_maps(a.landmarks, b.landmarks, view_of(a), view_of(b), MapAlignmentConfig{});
  if (alignment.status != AlignmentStatus::kAligned) {
    ++kept.num_unaligned;
    return kept;
  }
  std::map<std::pair<double, double>, int> tree_at;  // keep_ids() sorts
  for (std::size_t i = 0; i < b.landmarks.size(); ++i) {
    tree_at[{b.landmarks[i].x_m, b.landmarks[i].y_m}] = b.tree_of[i];
  }
  std::int32_t next_id = 1000;
  IdTransfer numbers = keep_ids(a.landmarks, alignment, next_id, b.landmarks);
  rows = find_rows(b.landmarks, RowsConfig{});
  keep_numbers(a.landmarks, rows, b.landmarks, numbers);
  std::set<std::pair<std::int32_t, std::int32_t>> given;
  for (const Landmark& l : b.landmarks) {
    const int tree = tree_at.at({l.x_m, l.y_m});
    if (l.position != 0) kept.num_twice += !given.insert({l.row, l.position}).second;
    const auto before = known.find(tree);
    const auto change = truth.find(tree);
    const bool is_moved = change != truth.end() && change->second == Change::kMoved;
    if (before == known.end()) {
      kept.num_reused += ids.count(l.id) != 0;
      continue;
    }
    if (is_moved) {  // its own id or one of its own, nobody else's
      kept.num_reused += l.id != before->second.id && ids.count(l.id) != 0;
      continue;
    }
    ++kept.num_pairs;
    kept.num_ids += l.id != before->second.id;
    kept.num_numbers += std::make_pair(l.row, l.position) != before->second.number;
  }
  return kept;
}

}  // namespace

bool run_ids(const Seeds& seeds) {
  Kept all;
  int num_whole = 0, num_seeds = 0;
  for (std::uint64_t seed = seeds.first; seed <= seeds.last; ++seed) {
    const Kept kept = map_again(seed);
    if (!kept.is_whole()) {
      std::printf("seed %llu: %d ids, %d numbers differ of %d; %d ids reused, %d numbers twice%s\n",
                  static_cast<unsigned long long>(seed), kept.num_ids, kept.num_numbers,
                  kept.num_pairs, kept.num_reused, kept.num_twice,
                  kept.num_unaligned != 0 ? "; not aligned" : "");
    }
    ++num_seeds;
    num_whole += kept.is_whole();
    all.add(kept);
  }
  std::printf(
      "%d of %d blocks whole: of %d trees in both maps %d with another id, %d with another number; "
      "%d ids reused, %d numbers twice, %d not aligned\n",
      num_whole, num_seeds, all.num_pairs, all.num_ids, all.num_numbers, all.num_reused,
      all.num_twice, all.num_unaligned);
  return num_whole == num_seeds;
}

}  // namespace orchard::trials
