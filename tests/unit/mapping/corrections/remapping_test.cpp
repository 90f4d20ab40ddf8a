// SPDX-License-Identifier: BSD-3-Clause
// Corrections of a map, and a second drive through the orchard when 5 % of it has changed. What
// truly stands where is known, so each correction can be followed to its thing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <set>

#include "mapping/compare/map_merging.hpp"
#include "mapping/corrections/apply_corrections.hpp"
#include "unit/mapping/compare/two_drives.hpp"

namespace orchard::mapping {
namespace {

using detection::Label;
using Eigen::Vector2d;
using Outcome = CorrectionOutcome;

/// Kept, or reported: what became of all corrections together.
struct Tally {
  int applied = 0, satisfied = 0;
  int reported_gone = 0;   ///< a conflict, and the thing is not in the new map
  int reported_there = 0;  ///< a conflict although the thing is in the new map
  int wrong = 0;           ///< passed for applied, and is not so
  int total = 0;
};

class Remapping {
 public:
  explicit Remapping(int seed) : dice_(static_cast<std::uint64_t>(seed)) {
    block_ = plant_block(dice_, 8, 25);
    drive_.last_aisle = 8;
    drive_.along_max_m = 51.0;
    drive_.bend_m = 0.2;
    a_ = drive_through(block_, drive_, dice_);
    std::vector<Row> rows = find_rows(a_.landmarks, RowsConfig{});
    number_landmarks(rows, a_.landmarks);
    for (std::size_t i = 0; i < a_.landmarks.size(); ++i) {
      free_.push_back(a_.tree_of[i]);
      landmark_of_[a_.tree_of[i]] = a_.landmarks[i];
    }
    edit();
    drive_again();
  }

  void count(Tally& tally) {
    const CorrectedMap corrected = apply_corrections(a_.landmarks, 1000, edits_);
    ASSERT_EQ(corrected.count(Outcome::kApplied), static_cast<int>(edits_.size()));
    const std::vector<Landmark> known = known_landmarks(a_.landmarks, corrected.landmarks);
    std::map<std::pair<double, double>, int> tree_at;
    for (std::size_t i = 0; i < b_.landmarks.size(); ++i) {
      tree_at[{b_.landmarks[i].x_m, b_.landmarks[i].y_m}] = b_.tree_of[i];
    }
    std::int32_t next_id = corrected.next_id;
    const MapAlignment alignment =
        align_maps(known, b_.landmarks, view_of(a_), view_of(b_), MapAlignmentConfig{});
    ASSERT_EQ(alignment.status, AlignmentStatus::kAligned);
    keep_ids(known, alignment, next_id, b_.landmarks);
    for (const Landmark& l : b_.landmarks) tree_of_id_[l.id] = tree_at.at({l.x_m, l.y_m});
    const CorrectedMap now = apply_corrections(
        b_.landmarks, next_id, carry_corrections(edits_, known, b_.landmarks, alignment.T_a_b));
    ASSERT_EQ(now.results.size(), edits_.size()) << "every one is reported";
    for (std::size_t i = 0; i < edits_.size(); ++i) judge(edits_[i], tree_[i], now, i, tally);
  }

 private:
  int take() {
    const auto i = static_cast<std::size_t>(dice_.uniform(0, static_cast<double>(free_.size())));
    const int tree = free_[i];
    free_.erase(free_.begin() + static_cast<std::ptrdiff_t>(i));
    return tree;
  }

  Correction& about(CorrectionKind kind, int tree, bool with_target = true) {
    Correction c;
    c.kind = kind;
    c.number = static_cast<int>(edits_.size()) + 1;
    const Landmark& l = landmark_of_[tree];
    if (with_target) c.targets = {{l.id, {l.x_m, l.y_m}, l.label, l.width_m}};
    edits_.push_back(c);
    tree_.push_back(tree);
    return edits_.back();
  }

  void edit() {
    std::set<int> missed;
    for (int k = 0; k < 12; ++k) {  // ghosts: what stands there is none
      ghosts_.insert(take());
      missed.insert(take());
    }
    for (const int tree : ghosts_) about(CorrectionKind::kDelete, tree);
    std::int32_t id = 1000;
    for (const int tree : missed) {
      const Landmark l = landmark_of_[tree];
      a_.landmarks.erase(std::find_if(a_.landmarks.begin(), a_.landmarks.end(),
                                      [&](const Landmark& x) { return x.id == l.id; }));
      Correction& add = about(CorrectionKind::kAdd, tree, false);
      add.new_id = id++;
      add.places_map = {{l.x_m + dice_.normal(0.05), l.y_m + dice_.normal(0.05)}};
      Correction& note = about(CorrectionKind::kNote, tree);
      note.targets[0] = {add.new_id, add.places_map[0], Label::kTree, 0.0};
      note.note = std::to_string(tree);
    }
    for (int k = 0; k < 10; ++k) {
      about(CorrectionKind::kClass, take()).label = Label::kObject;
      Correction& note = about(CorrectionKind::kNote, take());
      note.note = std::to_string(tree_.back());
      Correction& number = about(CorrectionKind::kRenumber, take());
      number.row = 77, number.position = k + 1;
      Correction& move = about(CorrectionKind::kMove, take());
      move.places_map = {move.targets[0].p_map + Vector2d(0.2, 0.1)};
    }
  }

  void drive_again() {
    for (std::size_t i = 0; i < block_.trees.size(); ++i) {
      TrueTree& t = block_.trees[i];
      const int tree = static_cast<int>(i);
      if (dice_.uniform(0, 1) < 0.05) t.stands = !t.stands;
      if (ghosts_.count(tree) != 0) t.stands = dice_.uniform(0, 1) < 0.5;
      if (landmark_of_.count(tree) != 0) t.width_m += 0.004;  // a season's growth
    }
    drive_.T_map_block = {dice_.uniform(-2, 2), dice_.uniform(-2, 2), dice_.uniform(-0.05, 0.05)};
    b_ = drive_through(block_, drive_, dice_);
  }

  /// The landmark of the corrected new map that is this tree; nullptr: none.
  const Landmark* find(const CorrectedMap& now, int tree) const {
    const Vector2d p =
        transform(drive_.T_map_block, block_.trees[static_cast<std::size_t>(tree)].p);
    const Landmark* best = nullptr;
    for (const Landmark& l : now.landmarks) {
      const auto known = tree_of_id_.find(l.id);
      if (known != tree_of_id_.end() && known->second == tree) return &l;
      if (known == tree_of_id_.end() && (Vector2d(l.x_m, l.y_m) - p).norm() < 0.45) best = &l;
    }
    return best;
  }

  void judge(const Correction& c, int tree, const CorrectedMap& now, std::size_t i, Tally& tally) {
    const bool is_mapped = std::any_of(tree_of_id_.begin(), tree_of_id_.end(),
                                       [&](const auto& entry) { return entry.second == tree; });
    ++tally.total;
    const CorrectionResult& result = now.results[i];
    if (result.outcome == Outcome::kConflict) {
      ++(is_mapped ? tally.reported_there : tally.reported_gone);
      return;
    }
    ++(result.outcome == Outcome::kSatisfied ? tally.satisfied : tally.applied);
    const Landmark* l = find(now, tree);
    bool is_so = l != nullptr;
    switch (c.kind) {
      case CorrectionKind::kDelete:
        is_so = l == nullptr;
        break;
      case CorrectionKind::kClass:
        is_so = is_so && l->label == Label::kObject;
        break;
      case CorrectionKind::kNote:
        is_so = is_so && now.notes.count(l->id) != 0 && now.notes.at(l->id).at(0) == c.note;
        break;
      case CorrectionKind::kRenumber:
        is_so = is_so && l->row == 77 && l->position == c.position;
        break;
      case CorrectionKind::kMove:
        for (const Landmark& mapped : b_.landmarks) {
          if (tree_of_id_.at(mapped.id) != tree) continue;
          const Vector2d p = Vector2d(mapped.x_m, mapped.y_m) +
                             geometry::rotation(drive_.T_map_block) * Vector2d(0.2, 0.1);
          is_so = is_so && (Vector2d(l->x_m, l->y_m) - p).norm() < 0.2;
        }
        break;
      default:
        break;
    }
    if (is_so) return;
    ++tally.wrong;
    ADD_FAILURE() << correction_word(c.kind) << " of tree " << tree << ": " << result.reason;
  }

  Dice dice_;
  Block block_;
  Drive drive_;
  DrivenMap a_, b_;
  std::vector<int> free_;  ///< mapped trees without a correction
  std::map<int, Landmark> landmark_of_;
  std::set<int> ghosts_;
  std::vector<Correction> edits_;
  std::vector<int> tree_;  ///< of each correction
  std::map<std::int32_t, int> tree_of_id_;
};

TEST(Remapping, KeepsOrReportsEveryCorrection) {
  Tally tally;
  for (int seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    Remapping(seed).count(tally);
  }
  std::printf(
      "%d corrections: %d applied, %d satisfied, %d reported whose thing is gone, %d reported "
      "whose thing is there, %d wrong\n",
      tally.total, tally.applied, tally.satisfied, tally.reported_gone, tally.reported_there,
      tally.wrong);
  EXPECT_EQ(tally.wrong, 0);
  EXPECT_LE(tally.reported_there, tally.total / 50);
}

}  // namespace
}  // namespace orchard::mapping
