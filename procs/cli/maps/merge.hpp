// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "mapping/compare/map_alignment.hpp"

namespace orchard::cli {

/// `orchard merge MAP_A MAP_B ... --out DIR`.
struct MergeOptions {
  std::vector<std::string> map_paths;  ///< map folders, or map.csv; the first gives frame and ids
  std::string previous_path;           ///< map whose ids and numbers are kept; empty: none
  bool leave_out = false;              ///< what cannot be laid is left out and said, not refused
  std::string out_folder;
  std::string config_path;  ///< for mapper.rows; empty: its defaults
  mapping::MapAlignmentConfig alignment;
  double reach_m = 0.0;  ///< of the laser; 0 = as the map folders say
};

/// Lays several maps of one orchard on each other and writes one map folder, with ids.csv that says
/// which landmark of which map became which; returns the exit code. Throws io::FileError for maps
/// that cannot be read or not be laid on each other without doubt, and before an input would be
/// overwritten; then nothing is written.
///
/// With leave_out the whole begins with the first map that lies on the previous one or, where there
/// is none, with that upon which most of the others can be laid; left_out.csv says what was left
/// out and why. Where no map has a majority behind it, nothing tells which is of the orchard, and
/// all are refused.
int run_merge(const MergeOptions& options);

}  // namespace orchard::cli
