// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>

#include "mapping/corrections/apply_corrections.hpp"
#include "worlds/landmark.hpp"

namespace orchard::mapping {
namespace {

using detection::Label;
using Outcome = CorrectionOutcome;
using ::testing::HasSubstr;

Landmark tree(std::int32_t id, double x_m, double y_m, double width_m = 0.1) {
  return test::tree(id, x_m, y_m, width_m, 9);
}

Correction about(CorrectionKind kind, std::int32_t number, const Landmark& l) {
  Correction c;
  c.kind = kind;
  c.number = number;
  c.targets = {{l.id, {l.x_m, l.y_m}, l.label, l.width_m}};
  return c;
}

/// Trees 2 m apart: reach is 0.5 m.
const std::vector<Landmark> kMap{tree(1, 0, 0), tree(2, 2, 0), tree(3, 4, 0), tree(4, 6, 0)};

TEST(Corrections, GoToWhatStandsThereAndIsAlikeWhenTheIdIsGone) {
  std::vector<Landmark> map = kMap;
  map[1].id = 9;
  map[1].x_m += 0.3;
  const CorrectedMap corrected =
      apply_corrections(map, 10, {about(CorrectionKind::kDelete, 1, kMap[1])});
  EXPECT_EQ(corrected.results[0].outcome, Outcome::kByPlace);
  EXPECT_THAT(corrected.results[0].reason, HasSubstr("9 is at the position of 2"));
  EXPECT_EQ(corrected.landmarks.size(), 3u);
}

TEST(Corrections, AMovedTreeKeepsItsHeightAsFarAsSlopesAllow) {
  std::vector<Landmark> map = kMap;
  map[1].z_m = 7.0, map[1].z_sd_m = 0.03;
  Correction move = about(CorrectionKind::kMove, 1, map[1]);
  move.places_map = {{2.3, 0.4}};  // by 0.5 m
  const CorrectedMap corrected = apply_corrections(map, 10, {move});
  const Landmark& moved = corrected.landmarks.at(1);
  ASSERT_EQ(moved.x_m, 2.3);
  EXPECT_EQ(moved.z_m, 7.0);
  EXPECT_NEAR(moved.z_sd_m, std::hypot(0.03, 0.12 * 0.5), 1e-12);
  EXPECT_EQ(corrected.landmarks.at(2).z_sd_m, 0.0);
}

TEST(Corrections, LeaveAnotherThingAlone) {
  std::vector<Landmark> map = kMap;
  map[1].id = 9;
  map[1].width_m = 0.3;  // no trunk grows by three: another one stands there
  const CorrectedMap wide =
      apply_corrections(map, 10, {about(CorrectionKind::kDelete, 1, kMap[1])});
  EXPECT_EQ(wide.results[0].outcome, Outcome::kConflict);
  EXPECT_EQ(wide.landmarks.size(), 4u);
  map[1].width_m = 0.1;
  map[1].label = Label::kObject;
  EXPECT_EQ(
      apply_corrections(map, 10, {about(CorrectionKind::kDelete, 1, kMap[1])}).results[0].outcome,
      Outcome::kConflict);
}

TEST(Corrections, DoNotFollowAnIdToAnotherPlace) {
  std::vector<Landmark> map = kMap;
  map[1].x_m = 20.0;
  const CorrectedMap corrected =
      apply_corrections(map, 5, {about(CorrectionKind::kNote, 1, kMap[1])});
  EXPECT_EQ(corrected.results[0].outcome, Outcome::kConflict);
  EXPECT_THAT(corrected.results[0].reason, HasSubstr("18.00 m"));
}

TEST(Corrections, AreSatisfiedByAMapThatKnows) {
  Correction add;
  add.kind = CorrectionKind::kAdd;
  add.number = 1;
  add.new_id = 5;
  add.places_map = {{2.2, 0.0}};
  Correction name_it = about(CorrectionKind::kNote, 2, tree(5, 2.2, 0.0));
  name_it.note = "planted in May";
  const Correction ghost = about(CorrectionKind::kDelete, 3, tree(7, 30, 30));
  const CorrectedMap map = apply_corrections(kMap, 5, {add, name_it, ghost});
  EXPECT_EQ(map.results[0].outcome, Outcome::kSatisfied);
  EXPECT_EQ(map.landmarks.size(), 4u);
  EXPECT_EQ(map.notes.at(2).at(0), "planted in May") << "5 is what the map calls 2";
  EXPECT_EQ(map.results[2].outcome, Outcome::kSatisfied);
  EXPECT_EQ(map.next_id, 6);
}

TEST(Corrections, GiveAnIdThatAnotherThingHasGotToNoSecond) {
  std::vector<Landmark> map = kMap;
  map.push_back(tree(5, 8, 0));
  Correction add;
  add.kind = CorrectionKind::kAdd;
  add.number = 1;
  add.new_id = 5;
  add.places_map = {{10.0, 0.0}};
  const Correction later = about(CorrectionKind::kNote, 2, tree(5, 10.0, 0.0));
  const CorrectedMap corrected = apply_corrections(map, 6, {add, later});
  EXPECT_EQ(corrected.results[0].outcome, Outcome::kByPlace);
  ASSERT_EQ(corrected.landmarks.size(), 6u);
  EXPECT_EQ(corrected.landmarks[4].x_m, 8.0);
  EXPECT_EQ(corrected.landmarks[5].id, 6);
  EXPECT_EQ(corrected.notes.count(6), 1u);
}

TEST(Corrections, KeepNumbersAndNamesApart) {
  std::vector<Landmark> map = kMap;
  for (std::size_t i = 0; i < map.size(); ++i) {
    map[i].row = i < 2 ? 1 : 2;
    map[i].position = static_cast<std::int32_t>(i % 2) + 1;
  }
  Correction taken = about(CorrectionKind::kRenumber, 1, map[0]);
  taken.row = 2, taken.position = 1;
  Correction name, again, nowhere;
  name.kind = again.kind = nowhere.kind = CorrectionKind::kRowName;
  name.number = 2, again.number = 3, nowhere.number = 4;
  name.row = 1, again.row = 2, nowhere.row = 8;
  name.name = again.name = "by the road";
  nowhere.name = "far";
  const CorrectedMap corrected = apply_corrections(map, 5, {taken, name, again, nowhere});
  EXPECT_THAT(corrected.results[0].reason, HasSubstr("row 2 tree 1 is already landmark 3"));
  EXPECT_EQ(corrected.results[1].outcome, Outcome::kApplied);
  EXPECT_EQ(corrected.results[2].outcome, Outcome::kConflict);
  EXPECT_EQ(corrected.results[3].outcome, Outcome::kConflict);
  EXPECT_EQ(corrected.row_names.at(1), "by the road");
}

TEST(Corrections, UndoneOnesLeaveLaterOnesFindable) {
  Correction move = about(CorrectionKind::kMove, 1, kMap[1]);
  move.places_map = {{2.0, 3.0}};
  const Correction note = about(CorrectionKind::kNote, 2, tree(2, 2.0, 3.0));
  Correction undo;
  undo.kind = CorrectionKind::kUndo;
  undo.number = 3;
  undo.of = 1;
  const CorrectedMap map = apply_corrections(kMap, 5, {move, note, undo});
  EXPECT_EQ(map.results[0].outcome, Outcome::kUndone);
  EXPECT_EQ(map.results[1].outcome, Outcome::kApplied);
  EXPECT_EQ(map.landmarks[1].y_m, 0.0);
}

}  // namespace
}  // namespace orchard::mapping
