// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "io/log/log_series.hpp"

namespace orchard::bus {

/// A configuration found in the CONFIG messages of a log.
struct LoggedRig {
  std::vector<std::string> processes;  ///< processes that used it, in order of appearance
  std::string version;                 ///< version of the first of them
  std::string yaml;                    ///< as written by io::effective_config()
};

/// Reads the distinct configurations of a log, in order of appearance. Ignores CONFIG messages that
/// are damaged or do not match their hash. Throws io::FileError when the log cannot be opened.
std::vector<LoggedRig> read_logged_rigs(const io::LogPaths& logs);

/// Returns the configuration with which a log was recorded: the one common to all processes or, if
/// `process` is not empty, that of this process. Throws io::FileError with advice when there is
/// none, or when several differ in keys that affect the map.
LoggedRig rig_of_log(const io::LogPaths& logs, const std::string& process = "");

}  // namespace orchard::bus
