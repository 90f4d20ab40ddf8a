// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bus/node/process_info.hpp"
#include "io/config/config_file.hpp"

namespace orchard::bus {

enum class ProcessKind {
  kNode,
  kDriver,  ///< publishes a paced source
  kDevice,  ///< publishes a sensor at its own pace
};

/// Parsed command line of a process.
struct ProcessOptions {
  io::EffectiveConfig config;  ///< effective configuration, with the lcm.url in use
  bool lockstep = false;
  double speed = 1.0;
  std::vector<std::string> wait_for;  ///< full names of processes
  bool hold = false;
};

/// Version of the software.
std::string_view version();

/// Selects the LCM network: --lcm-url if given, else the rig's URL, else LCM_DEFAULT_URL, else the
/// built-in default. Returns the origin of the URL in words.
const char* choose_url(const std::string& lcm_url, bool has_rig, io::LcmConfig& lcm);

/// Loads the rig at `path` (empty: keeps the defaults), logs the reader's warnings and prints its
/// errors. Returns false when the rig is invalid.
bool load_config(const std::string& program, const std::string& path, io::ConfigFile& config);

/// Parses the command line, loads the configuration, prints errors in either and sets the log
/// level. Returns the exit code if the program must end here (also after --help).
std::optional<int> read_options(int argc, char** argv, const ProcessInfo& info, ProcessKind kind,
                                io::ConfigFile& config, ProcessOptions& options);

}  // namespace orchard::bus
