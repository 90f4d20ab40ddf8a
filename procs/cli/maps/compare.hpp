// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "mapping/compare/map_comparison.hpp"

namespace orchard::cli {

/// `orchard compare MAP_A MAP_B`.
struct CompareOptions {
  std::string earlier_path;  ///< a map folder, or its map.csv
  std::string later_path;
  std::string out_folder;  ///< empty: only prints
  mapping::MapAlignmentConfig alignment;
  mapping::ComparisonConfig comparison;
  double reach_m = 0.0;    ///< max range of the laser; 0: that of the map folders
  bool as_mapped = false;  ///< without manual corrections
  bool json = false;
};

/// Registers the later map to the earlier one, prints the changes and writes them into a folder;
/// returns the exit code. Throws io::FileError for maps that cannot be read, that cannot be
/// aligned, or whose alignment is ambiguous.
int run_compare(const CompareOptions& options);

}  // namespace orchard::cli
