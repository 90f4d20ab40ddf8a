// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "mapping/corrections/correction.hpp"

namespace orchard::cli {

/// `orchard edit MAP KIND ...`.
struct EditOptions {
  std::string map_folder;
  mapping::CorrectionKind kind = mapping::CorrectionKind::kNote;
  std::string tree;                ///< id, or row/tree
  std::vector<std::string> trees;  ///< the same, for merge
  std::vector<double> at_m;        ///< x y [x y] in map
  std::string class_word = "tree";
  double width_m = 0.0;
  std::string row;
  std::string name;
  int position = 0;
  int of = 0;  ///< number of the correction for undo and redo; 0: the last
  std::string who;
  std::string note;
  std::string out_folder;  ///< apply
  bool json = false;       ///< list, check
};

/// Adds one correction to the map's corrections; returns the exit code. Throws io::FileError,
/// without adding it, when it is impossible or would contradict the map.
int run_edit(const EditOptions& options);

/// Prints the corrections and the outcome of each.
int run_edit_list(const EditOptions& options);

/// Prints the corrections in conflict; returns exit code 3 when there are any.
int run_edit_check(const EditOptions& options);

/// Writes the corrected map to a separate folder.
int run_edit_apply(const EditOptions& options);

/// The name of the current user, from the system.
std::string person();

}  // namespace orchard::cli
