// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cli/field/child_process.hpp"
#include "io/config/config.hpp"

namespace orchard::cli {

/// What `orchard live` was asked for.
struct LiveOptions {
  std::string config_path;
  std::string lcm_url;
  std::string out_folder;         ///< for the map; empty: out/live/DATE
  std::string record_folder;      ///< empty: nothing is recorded
  std::vector<std::string> only;  ///< processes by name, with or without "orchard-"; "drivers"
  std::vector<std::string> without;
  std::string scene;  ///< orchard-sim-driver in place of the rig's drivers
  std::string seed = "1";
  std::string speed = "1";      ///< of the simulated drive, times real time
  std::string played_log;      ///< what the devices of the drivers play, each in its own protocol
  std::string viewer_address;  ///< ADDRESS:PORT where the viewer serves its page; empty: none
  bool edit = false;  ///< on that page people may correct the map
};

/// The processes of one machine, in the order in which they are started. `program_folder`: where
/// the executables are. Throws io::FileError for a name that is none and when nothing would be
/// started.
std::vector<ChildPlan> plan_launch(const LiveOptions& options, const io::Config& config,
                                   const std::string& program_folder);

}  // namespace orchard::cli
