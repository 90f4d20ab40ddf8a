// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "mapping/compare/map_alignment.hpp"

namespace orchard::cli {

/// `orchard map LOG... --out DIR`.
struct MapOptions {
  std::vector<std::string> log_paths;  ///< of one drive, in any order
  std::string config_path;             ///< empty: the rig that the log carries
  std::string out_folder;
  std::string previous_path;  ///< map whose ids and numbers are kept; empty: none
  mapping::MapAlignmentConfig previous_alignment;
  bool strict = false;      ///< refuse a log with any damage or any message that has to be dropped
  bool quiet = false;       ///< no progress and no closing summary; warnings and errors still come
  bool no_derived = false;  ///< no derived.lcm, the messages on the way; an earlier one is removed
  int num_jobs = 0;         ///< threads at once; 0: one for each core
  bool timing = false;      ///< print what every thousand scans took
};

/// Replays a log, or the pieces of one, through detector, pose and mapper in this process and
/// writes the map folder; returns the exit code. Throws io::FileError and io::ConfigError, and then
/// leaves an earlier map in the folder as it was; Interrupted as well.
int run_map(const MapOptions& options);

}  // namespace orchard::cli
