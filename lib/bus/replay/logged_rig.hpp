// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "io/log/log_series.hpp"

namespace orchard::bus {

/// A configuration that a log's CONFIG messages carry.
struct LoggedRig {
  std::vector<std::string> processes;  ///< that ran with it, in order of appearance
  std::string version;                 ///< of the first of them
  std::string yaml;                    ///< as io::effective_config() writes it
};

/// The different configurations of a log, in order of appearance. CONFIG messages that are damaged
/// or contradict their hash are left out. Throws io::FileError when the log cannot be opened.
std::vector<LoggedRig> read_logged_rigs(const io::LogPaths& logs);

/// The configuration of a log: the one that all its processes ran with or, when `process` is not
/// empty, the one of that process. Throws io::FileError, in a sentence that says what to do, when
/// there is none, and when several disagree about the map.
LoggedRig rig_of_log(const io::LogPaths& logs, const std::string& process = "");

}  // namespace orchard::bus
