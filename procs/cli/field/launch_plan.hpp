// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cli/field/child_process.hpp"
#include "io/config/config.hpp"

namespace orchard::cli {

/// Command-line options of `orchard live`.
struct LiveOptions {
  std::string config_path;
  std::string lcm_url;
  std::string out_folder;         ///< map folder; empty: out/live/DATE
  std::string record_folder;      ///< empty: no recording
  std::vector<std::string> only;  ///< processes by name, with or without "orchard-"; "drivers"
  std::vector<std::string> without;
  std::string scene;  ///< orchard-sim-driver in place of the rig's drivers
  std::string seed = "1";
  std::string speed = "1";     ///< speed of the simulated drive relative to real time
  std::string played_log;      ///< log that emulated devices play, each in its own protocol
  std::string viewer_address;  ///< ADDRESS:PORT of the viewer's page; empty: none
  bool edit = false;           ///< users may correct the map on that page
};

/// Plans the processes of this machine, in the order of their start. `program_folder`: the folder
/// of the executables. Throws io::FileError for an unknown name and when no process would be
/// started.
std::vector<ChildPlan> plan_launch(const LiveOptions& options, const io::Config& config,
                                   const std::string& program_folder);

}  // namespace orchard::cli
