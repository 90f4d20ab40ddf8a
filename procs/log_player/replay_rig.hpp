// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "io/config/config.hpp"
#include "io/log/log_series.hpp"

namespace orchard::procs {

/// The configuration to replay a log with.
struct ReplayRig {
  io::Config config;
  std::string name;                ///< where it is from, for people: a file, or "the rig in a.lcm"
  std::vector<std::string> notes;  ///< for people: keys of an earlier release, and what
                                   ///< differs from the rig in the log
};

/// The rig of `config_path`, compared with the one in the log, or the log's own when `config_path`
/// is empty. Throws io::ConfigError, and io::FileError as bus::rig_of_log() does.
ReplayRig choose_rig(const io::LogPaths& logs, const std::string& config_path);

}  // namespace orchard::procs
