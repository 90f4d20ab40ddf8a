// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "io/config/config.hpp"
#include "io/log/log_series.hpp"

namespace orchard::cli {

/// `orchard learn LOG... --out RIG`.
struct LearnOptions {
  std::vector<std::string> log_paths;  ///< logs of one drive, in any order
  std::string config_path;             ///< rig to complete; empty: none
  std::string out_path;
  bool quiet = false;
};

/// A rig as its drive shows it.
struct LearntRig {
  std::string yaml;  ///< each value with a comment: how it was seen, and how surely
  io::Config config;
  std::vector<std::string> seen;   ///< what was learnt, a line each
  std::vector<std::string> asked;  ///< what the drive does not show, and how to find it
};

/// Learns what a drive tells about its rig, beginning with the YAML text `base` (may be empty; what
/// is not seen of it stays): the sensors from the channels, mount, antenna, range noise, blind
/// sector, reach and trunk width from mapping it twice. Throws io::FileError for logs without
/// scans, and io::ConfigError.
LearntRig learn_rig(const char* command, const io::LogPaths& logs, const std::string& base,
                    bool quiet);

/// Learns the rig of a drive, tells it, and writes it; returns the exit code. Throws io::FileError
/// and io::ConfigError, and then writes nothing.
[[gnu::weak]] int run_learn(const LearnOptions& options);

}  // namespace orchard::cli
