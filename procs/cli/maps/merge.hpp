// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "mapping/compare/map_alignment.hpp"

namespace orchard::cli {

/// `orchard merge MAP_A MAP_B ... --out DIR`.
struct MergeOptions {
  std::vector<std::string> map_paths;  ///< map folders or map.csv; the first gives frame and ids
  std::string previous_path;           ///< earlier map whose ids and numbers are kept; empty: none
  bool leave_out = false;  ///< leave out maps that cannot be registered instead of failing
  std::string out_folder;
  std::string config_path;  ///< for mapper.rows; empty: its defaults
  mapping::MapAlignmentConfig alignment;
  double reach_m = 0.0;  ///< max range of the laser; 0: that of the map folders
};

/// Registers several maps of one orchard to each other and writes one map folder. Its ids.csv tells
/// the merged landmark of each input landmark. Returns the exit code. Throws io::FileError for maps
/// that cannot be read or whose registration fails or is ambiguous, and before an input would be
/// overwritten; then writes nothing.
///
/// With leave_out the merge starts from the first map that can be registered to the previous one;
/// without a previous one, from the map to which most others can be registered. left_out.csv lists
/// the maps left out and the reasons. Without a majority for any map it is unknown which maps show
/// the orchard, and all are rejected.
int run_merge(const MergeOptions& options);

}  // namespace orchard::cli
