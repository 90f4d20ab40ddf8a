// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "io/map/corrected_map.hpp"

namespace orchard::io {

/// A correction as requested by the user, with names instead of ids: `orchard edit`, and the page.
struct MapEdit {
  mapping::CorrectionKind kind = mapping::CorrectionKind::kNote;
  /// Ids, or row/tree. Merge needs two or more, add has one gap or none, all other kinds that
  /// concern a landmark need one.
  std::vector<std::string> trees;
  std::vector<Eigen::Vector2d> places_map;
  std::string class_word = "tree";
  double width_m = 0.0;
  std::string row;  ///< number or name
  std::string name;
  int position = 0;
  int of = 0;  ///< number of the correction to undo or redo; 0: the last
  std::string who;
  std::string note;
};

/// Result of an edit.
struct MapEditEffect {
  mapping::Correction correction;
  CorrectedMapFolder before, after;

  /// Describes earlier corrections that now conflict because of the new one: "correction 3 (move)
  /// is in conflict now: ...".
  std::vector<std::string> new_conflicts() const;

  /// Describes the new correction: "correction 3: delete 17".
  std::string words() const;
};

/// Creates a correction of `mapped` and appends it to the folder's corrections, after those
/// appended by others meanwhile. Throws FileError when it is invalid, contradicts the map, changes
/// nothing, or cannot be written; nothing is appended then.
MapEditEffect edit_map(const std::string& folder, const StoredMap& mapped, const MapEdit& edit);

}  // namespace orchard::io
