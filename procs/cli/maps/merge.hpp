// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "mapping/compare/map_alignment.hpp"

namespace orchard::cli {

/// `orchard merge MAP_A MAP_B ... --out DIR`.
struct MergeOptions {
  std::vector<std::string> map_paths;  ///< map folders, or map.csv; the first gives frame and ids
  std::string out_folder;
  std::string config_path;  ///< for mapper.rows; empty: its defaults
  mapping::MapAlignmentConfig alignment;
  double reach_m = 0.0;  ///< of the laser; 0 = as the map folders say
};

/// Lays several maps of one orchard on each other and writes one map folder, with ids.csv that says
/// which landmark of which map became which; returns the exit code. Throws io::FileError for maps
/// that cannot be read or not be laid on each other without doubt, and before an input would be
/// overwritten; then nothing is written.
int run_merge(const MergeOptions& options);

}  // namespace orchard::cli
