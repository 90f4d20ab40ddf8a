// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "mapping/compare/map_alignment.hpp"

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
int run_map(const MapOptions& options);

}  // namespace orchard::cli
