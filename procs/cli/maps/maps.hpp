// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "mapping/compare/map_alignment.hpp"
#include "mapping/compare/map_comparison.hpp"

namespace orchard::cli {

/// `orchard map LOG... --out DIR`.
struct MapOptions {
  std::vector<std::string> log_paths;  ///< logs of one drive, in any order
  std::string config_path;             ///< empty: the rig stored in the log
  std::string out_folder;
  std::string previous_path;  ///< earlier map whose ids and numbers are kept; empty: none
  mapping::MapAlignmentConfig previous_alignment;
  bool strict = false;      ///< reject a log with any damage or any dropped message
  bool quiet = false;       ///< no progress and no summary; warnings and errors are still printed
  bool no_derived = false;  ///< no derived.lcm (intermediate messages); removes an earlier one
  int num_jobs = 0;         ///< number of threads; 0: one per core
  bool timing = false;      ///< print the cost of every thousand scans
};

/// Replays a log, or its parts, through detector, pose and mapper in this process and writes the
/// map folder; returns the exit code. Throws io::FileError, io::ConfigError and Interrupted, and
/// then leaves an earlier map in the folder unchanged.
[[gnu::weak]] int run_map(const MapOptions& options);

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
[[gnu::weak]] int run_compare(const CompareOptions& options);

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
[[gnu::weak]] int run_merge(const MergeOptions& options);

}  // namespace orchard::cli
