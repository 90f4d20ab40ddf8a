// SPDX-License-Identifier: BSD-3-Clause
// Random corrections against a model that knows none of the code: a copy of the whole state per
// step.
#include <gtest/gtest.h>

#include <map>
#include <random>

#include "mapping/corrections/apply_corrections.hpp"
#include "worlds/landmark.hpp"

namespace orchard::mapping {
namespace {

using detection::Label;
using Eigen::Vector2d;

struct EditedObject {
  Vector2d p{0, 0};
  Label label = Label::kTree;
  int row = 0, position = 0;
  std::vector<std::string> notes;
};

struct State {
  std::map<int, EditedObject> objects;
  std::map<int, std::string> row_names;
};

std::vector<Landmark> orchard_of(int num_rows, int num_trees, std::mt19937& random) {
  std::normal_distribution<double> scatter(0.0, 0.05);
  std::vector<Landmark> map;
  for (int i = 0; i < num_rows * num_trees; ++i) {
    const double x_m = 2.0 * (i % num_trees) + scatter(random);
    const double y_m = 4.0 * (i / num_trees) + scatter(random);
    const Label label = i % 13 == 5 ? Label::kObject : Label::kTree;
    Landmark l = test::landmark(i + 1, label, x_m, y_m, 0.1, 9);
    if (l.label == Label::kTree) l.row = i / num_trees + 1, l.position = i % num_trees + 1;
    map.push_back(l);
  }
  return map;
}

/// A person who edits what is seen, and the model of what that should give.
class Editor {
 public:
  Editor(unsigned seed, int num_rows, int num_trees)
      : random_(seed), map_(orchard_of(num_rows, num_trees, random_)) {
    for (const Landmark& l : map_) {
      states_.resize(1);
      states_[0].objects[l.id] = {{l.x_m, l.y_m}, l.label, l.row, l.position, {}};
    }
    next_id_ = static_cast<int>(map_.size()) + 1;
  }

  void edit() {
    Correction c;
    c.number = static_cast<int>(corrections_.size()) + 1;
    c.who = "Ana";
    const int what = pick(14);
    if (what == 0 && states_.size() > 1) {
      c.kind = CorrectionKind::kUndo;
      c.of = last_to_undo(corrections_);
      ASSERT_EQ(c.of, numbers_.back());
      undone_.push_back({numbers_.back(), states_.back()});
      numbers_.pop_back();
      states_.pop_back();
    } else if (what == 1 && !undone_.empty()) {
      c.kind = CorrectionKind::kRedo;
      c.of = last_to_redo(corrections_);
      ASSERT_EQ(c.of, undone_.back().first);
      numbers_.push_back(c.of);
      states_.push_back(undone_.back().second);
      undone_.pop_back();
    } else {
      State state = states_.back();
      fill(what, c, state);
      numbers_.push_back(c.number);
      states_.push_back(state);
      undone_.clear();
    }
    corrections_.push_back(c);
  }

  void compare() const {
    const CorrectedMap map =
        apply_corrections(map_, static_cast<int>(map_.size()) + 1, corrections_);
    ASSERT_EQ(map.results.size(), corrections_.size());
    EXPECT_EQ(map.count(CorrectionOutcome::kConflict), 0);
    EXPECT_EQ(map.count(CorrectionOutcome::kByPlace), 0);
    EXPECT_EQ(map.count(CorrectionOutcome::kSatisfied), 0);
    const State& state = states_.back();
    ASSERT_EQ(map.landmarks.size(), state.objects.size());
    EXPECT_EQ(map.next_id, next_id_);
    EXPECT_TRUE(map.row_names == state.row_names);
    for (const Landmark& l : map.landmarks) {
      ASSERT_EQ(state.objects.count(l.id), 1u) << l.id;
      const EditedObject& object = state.objects.at(l.id);
      EXPECT_EQ(l.label, object.label);
      EXPECT_LT((Vector2d(l.x_m, l.y_m) - object.p).norm(), 1e-9);
      EXPECT_EQ(l.row, object.row) << l.id;
      EXPECT_EQ(l.position, object.position) << l.id;
      const auto notes = map.notes.find(l.id);
      EXPECT_TRUE((notes == map.notes.end() ? std::vector<std::string>() : notes->second) ==
                  object.notes);
    }
  }

 private:
  int pick(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random_); }
  double length() { return std::uniform_real_distribution<double>(-1.0, 1.0)(random_); }

  static CorrectionTarget target(const std::pair<const int, EditedObject>& entry) {
    return {entry.first, entry.second.p, entry.second.label, 0.0};
  }
  std::map<int, EditedObject>::iterator any(State& state) {
    return std::next(state.objects.begin(), pick(static_cast<int>(state.objects.size())));
  }
  /// A place where nothing stands within 0.8 m.
  Vector2d free_place(const State& state) {
    for (;;) {
      const Vector2d p(30.0 * length(), 30.0 * length());
      bool is_free = true;
      for (const auto& [id, object] : state.objects) is_free &= (object.p - p).norm() > 0.8;
      if (is_free) return p;
    }
  }

  void fill(int what, Correction& c, State& state) {
    const auto one = any(state);
    EditedObject& object = one->second;
    if (what <= 3) {
      c.kind = CorrectionKind::kAdd;
      c.new_id = next_id_++;
      c.places_map = {free_place(state)};
      c.label = pick(2) ? Label::kTree : Label::kObject;
      state.objects[c.new_id] = {c.places_map[0], c.label, 0, 0, {}};
    } else if (what <= 5) {
      c.kind = CorrectionKind::kDelete;
      c.targets = {target(*one)};
      state.objects.erase(one);
    } else if (what == 6) {
      c.kind = CorrectionKind::kMove;
      c.targets = {target(*one)};
      c.places_map = {free_place(state)};
      object.p = c.places_map[0];
    } else if (what <= 8) {
      c.kind = CorrectionKind::kClass;
      c.targets = {target(*one)};
      c.label = object.label = pick(2) ? Label::kTree : Label::kObject;
      if (c.label == Label::kObject) object.row = object.position = 0;
    } else if (what == 9) {
      merge(c, state);
    } else if (what == 10) {
      c.kind = CorrectionKind::kSplit;
      c.targets = {target(*one)};
      c.new_id = next_id_++;
      c.places_map = {free_place(state), {0, 0}};
      c.places_map[1] = c.places_map[0] + Vector2d(0.6, 0.0);
      object.p = c.places_map[0];
      state.objects[c.new_id] = {c.places_map[1], object.label, 0, 0, {}};
    } else if (what == 11) {
      c.kind = CorrectionKind::kRowName;
      c.row = 1 + pick(3);
      c.name = "name " + std::to_string(c.number);
      state.row_names[c.row] = c.name;
    } else if (what == 12) {
      c.kind = CorrectionKind::kRenumber;
      c.targets = {target(*one)};
      c.row = object.row = 7;
      c.position = object.position = 1000 + c.number;
    } else {
      c.kind = CorrectionKind::kNote;
      c.targets = {target(*one)};
      c.note = "note " + std::to_string(c.number);
      object.notes.push_back(c.note);
    }
  }

  /// Of two trees: which class a tree and an object have together is another test's question.
  void merge(Correction& c, State& state) {
    const auto is_tree = [](const auto& x) { return x->second.label == Label::kTree; };
    auto one = any(state), other = any(state);
    while (!is_tree(one)) one = any(state);
    while (!is_tree(other) || other == one) other = any(state);
    c.kind = CorrectionKind::kMerge;
    c.targets = {target(*one), target(*other)};
    c.places_map = {one->second.p};
    EditedObject& a = one->second;
    const EditedObject& b = other->second;
    for (const std::string& note : b.notes) a.notes.push_back(note);
    if (a.row == 0) a.row = b.row, a.position = b.position;
    state.objects.erase(other);
  }

  std::mt19937 random_;
  std::vector<Landmark> map_;
  std::vector<Correction> corrections_;
  std::vector<State> states_{1};
  std::vector<int> numbers_;
  std::vector<std::pair<int, State>> undone_;
  int next_id_ = 1;
};

TEST(RandomEdits, FiveHundredWithUndoAreWhatTheModelSays) {
  for (const unsigned seed : {1u, 2u, 3u, 4u}) {
    Editor editor(seed, 6, 15);
    for (int i = 0; i < 500 && !::testing::Test::HasFatalFailure(); ++i) {
      editor.edit();
      if (i % 25 == 24) editor.compare();
    }
    editor.compare();
  }
}

}  // namespace
}  // namespace orchard::mapping
