// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "detection/detection.hpp"

namespace orchard::mapping {

/// Kinds of corrections.
enum class CorrectionKind {
  kDelete,    ///< the landmark does not exist
  kAdd,       ///< an object exists that the map lacks
  kMove,      ///< the position is wrong
  kClass,     ///< the class (tree or object) is wrong
  kMerge,     ///< two or more landmarks are one object; the first stays
  kSplit,     ///< one landmark is two objects
  kRowName,   ///< name of a row
  kRenumber,  ///< row and position of a tree
  kNote,      ///< text about a landmark
  kUndo,      ///< takes back an earlier correction
  kRedo,      ///< restores an undone correction
};
inline constexpr CorrectionKind kAllCorrectionKinds[] = {
    CorrectionKind::kDelete,  CorrectionKind::kAdd,      CorrectionKind::kMove,
    CorrectionKind::kClass,   CorrectionKind::kMerge,    CorrectionKind::kSplit,
    CorrectionKind::kRowName, CorrectionKind::kRenumber, CorrectionKind::kNote,
    CorrectionKind::kUndo,    CorrectionKind::kRedo};

/// Name of a kind in files and commands: "delete", "add", ...
const char* correction_word(CorrectionKind kind);

/// A landmark as it was when it was corrected; found again by id, else by position, class and
/// width.
struct CorrectionTarget {
  std::int32_t id = 0;
  Eigen::Vector2d p_map{0.0, 0.0};
  detection::Label label = detection::Label::kUnseen;
  double width_m = 0.0;  ///< 0: unknown
};

/// A correction of the map by a person.
struct Correction {
  std::int32_t number = 0;  ///< serial number, from 1
  std::int64_t utime = 0;   ///< time of the correction; set by the caller
  std::string who;
  CorrectionKind kind = CorrectionKind::kNote;
  /// Landmarks concerned. delete, move, class, split, renumber, note: one; merge: several, the
  /// first stays.
  std::vector<CorrectionTarget> targets;
  /// Positions. add, move, merge: one; split: two, the first keeps its id.
  std::vector<Eigen::Vector2d> places_map;
  std::int32_t new_id = 0;                           ///< id of the landmark created by add or split
  detection::Label label = detection::Label::kTree;  ///< add, class
  double width_m = 0.0;                              ///< add; 0: unknown
  std::int32_t row = 0;                              ///< row, renumber
  std::int32_t position = 0;                         ///< renumber; 0: none
  std::string name;                                  ///< row
  std::int32_t of = 0;  ///< undo, redo: number of the correction concerned
  std::string note;     ///< reason; for kNote the text
};

}  // namespace orchard::mapping
