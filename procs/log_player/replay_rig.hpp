// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "io/config/config.hpp"
#include "io/log/log_series.hpp"

namespace orchard::procs {

/// The configuration for a replay of a log.
struct ReplayRig {
  io::Config config;
  std::string name;  ///< origin, for the user: a file, or "the rig in a.lcm"
  std::vector<std::string>
      notes;  ///< for the user: keys of an earlier release, changes to the logged rig
};

/// Reads the rig of `config_path` and compares it with the one in the log; an empty `config_path`
/// selects the log's own. Throws io::ConfigError, and io::FileError like bus::rig_of_log().
ReplayRig choose_rig(const io::LogPaths& logs, const std::string& config_path);

}  // namespace orchard::procs
