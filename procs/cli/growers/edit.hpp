// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "mapping/corrections/correction.hpp"

namespace orchard::cli {

/// `orchard edit MAP WHAT ...`.
struct EditOptions {
  std::string map_folder;
  mapping::CorrectionKind kind = mapping::CorrectionKind::kNote;
  std::string tree;                ///< id, or row/tree
  std::vector<std::string> trees;  ///< the same, of merge
  std::vector<double> at_m;        ///< x y [x y] in map
  std::string class_word = "tree";
  double width_m = 0.0;
  std::string row;
  std::string name;
  int position = 0;
  int of = 0;  ///< undo, redo; 0: the last
  std::string who;
  std::string note;
  std::string out_folder;  ///< apply
  bool json = false;       ///< list, check
};

/// Adds one correction to the map's; returns the exit code. Throws io::FileError when it cannot be
/// made or would contradict the map; nothing is added then.
int run_edit(const EditOptions& options);

/// Prints the corrections and what became of each.
int run_edit_list(const EditOptions& options);

/// The same, of conflicts alone; exit code 3 when there are some.
int run_edit_check(const EditOptions& options);

/// Writes the corrected map as a folder of its own.
int run_edit_apply(const EditOptions& options);

/// Who is at the keyboard, as the system knows it.
std::string person();

}  // namespace orchard::cli
