// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "mapping/compare/map_comparison.hpp"

namespace orchard::cli {

/// `orchard compare MAP_A MAP_B`.
struct CompareOptions {
  std::string earlier_path;  ///< a map folder, or its map.csv
  std::string later_path;
  std::string out_folder;  ///< empty: only what is printed
  mapping::MapAlignmentConfig alignment;
  mapping::ComparisonConfig comparison;
  double reach_m = 0.0;    ///< of the laser; 0 = as the map folders say
  bool as_mapped = false;  ///< without what people corrected
  bool json = false;
};

/// Lays the later map on the earlier one, tells what changed, prints it and writes it into a
/// folder; returns the exit code. Throws io::FileError for maps that cannot be read, that cannot be
/// aligned, or that can be aligned in more than one way.
int run_compare(const CompareOptions& options);

}  // namespace orchard::cli
