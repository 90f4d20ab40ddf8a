// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "detection/detection.hpp"

namespace orchard::mapping {

enum class CorrectionKind {
  kDelete,    ///< nothing stands there: a ghost
  kAdd,       ///< something stands there that the map lacks
  kMove,      ///< it stands elsewhere
  kClass,     ///< it is a tree, or an object
  kMerge,     ///< two or more landmarks are one thing, the first of them
  kSplit,     ///< one landmark is two things
  kRowName,   ///< what people call a row
  kRenumber,  ///< row and position of a tree
  kNote,      ///< words about a landmark
  kUndo,      ///< an earlier correction does not hold
  kRedo,      ///< an undone correction holds again
};
inline constexpr CorrectionKind kAllCorrectionKinds[] = {
    CorrectionKind::kDelete,  CorrectionKind::kAdd,      CorrectionKind::kMove,
    CorrectionKind::kClass,   CorrectionKind::kMerge,    CorrectionKind::kSplit,
    CorrectionKind::kRowName, CorrectionKind::kRenumber, CorrectionKind::kNote,
    CorrectionKind::kUndo,    CorrectionKind::kRedo};

/// "delete", "add" ...: a kind as files and commands have it.
const char* correction_word(CorrectionKind kind);

/// A landmark as it was when somebody corrected it: found again by its id, else by what it was.
struct CorrectionTarget {
  std::int32_t id = 0;
  Eigen::Vector2d p_map{0.0, 0.0};
  detection::Label label = detection::Label::kUnseen;
  double width_m = 0.0;  ///< 0: unknown
};

/// One thing that a person knows better than the map.
struct Correction {
  std::int32_t number = 0;  ///< of the correction, rising from 1
  std::int64_t utime = 0;   ///< when it was made; given from outside
  std::string who;
  CorrectionKind kind = CorrectionKind::kNote;
  /// delete, move, class, split, renumber, note: one; merge: the first stays.
  std::vector<CorrectionTarget> targets;
  std::vector<Eigen::Vector2d> places_map;  ///< add, move: one; split: two, the first keeps its id
  std::int32_t new_id = 0;                  ///< of what add and split bring
  detection::Label label = detection::Label::kTree;  ///< add, class
  double width_m = 0.0;                              ///< add; 0: unknown
  std::int32_t row = 0;                              ///< row, renumber
  std::int32_t position = 0;                         ///< renumber; 0: none
  std::string name;                                  ///< row
  std::int32_t of = 0;                               ///< undo, redo: the number of another
  std::string note;                                  ///< why; of a note its text
};

}  // namespace orchard::mapping
