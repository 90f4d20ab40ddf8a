// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "io/map/corrected_map.hpp"

namespace orchard::io {

/// A correction as a person asks for it, in names: `orchard edit`, and the page.
struct MapEdit {
  mapping::CorrectionKind kind = mapping::CorrectionKind::kNote;
  /// Ids, or row/tree: of merge two or more, of add one gap or none, of all else that is about a
  /// landmark one.
  std::vector<std::string> trees;
  std::vector<Eigen::Vector2d> places_map;
  std::string class_word = "tree";
  double width_m = 0.0;
  std::string row;  ///< number or name
  std::string name;
  int position = 0;
  int of = 0;  ///< undo, redo; 0: the last
  std::string who;
  std::string note;
};

/// What an edit did.
struct MapEditEffect {
  mapping::Correction correction;
  CorrectedMapFolder before, after;

  /// Earlier corrections that the new one has brought into conflict: "correction 3 (move) is in
  /// conflict now: ...".
  std::vector<std::string> new_conflicts() const;

  /// "correction 3: delete 17", for people.
  std::string words() const;
};

/// Makes the correction of `mapped` and adds it to the corrections of its folder, after all that
/// others have added by then. Throws FileError when it cannot be made, would contradict the map or
/// change nothing, or cannot be written; nothing is added then.
MapEditEffect edit_map(const std::string& folder, const StoredMap& mapped, const MapEdit& edit);

}  // namespace orchard::io
