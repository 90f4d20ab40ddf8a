// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bus/node/process.hpp"
#include "io/config/config_file.hpp"

namespace orchard::bus {

enum class ProcessKind {
  kNode,
  kDriver,  ///< of a source that is paced
  kDevice,  ///< of a sensor with a pace of its own
};

/// What the command line of a process said.
struct ProcessOptions {
  io::EffectiveConfig config;  ///< with the lcm.url to use
  bool lockstep = false;
  double speed = 1.0;
  std::vector<std::string> wait_for;  ///< full names of processes
  bool hold = false;
};

/// Version of the software.
std::string_view version();

/// The LCM network: --lcm-url when given, else the rig's, else LCM_DEFAULT_URL, else the built-in
/// one. Returns which of them, in words.
const char* choose_url(const std::string& lcm_url, bool has_rig, io::LcmConfig& lcm);

/// Loads the rig at `path` ("": the defaults stay), logs the reader's warnings and prints what is
/// wrong with it; false when it was refused.
bool load_config(const std::string& program, const std::string& path, io::ConfigFile& config);

/// Reads the command line and the configuration, prints what is wrong with them, and sets the log
/// level. Returns the exit code when the program is to end here (also after --help).
std::optional<int> read_options(int argc, char** argv, const ProcessInfo& info, ProcessKind kind,
                                io::ConfigFile& config, ProcessOptions& options);

}  // namespace orchard::bus
