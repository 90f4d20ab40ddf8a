// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::cli {

/// `orchard publish MAP --to URL --block NAME`.
struct PublishOptions {
  std::string map_path;
  std::string url;
  std::string block;
  std::string date;  ///< empty: the date of the drive
  bool as_mapped = false;
  bool json = false;
};

/// Writes a map with its manual corrections to PostGIS; returns the exit code. Throws
/// io::FileError, and std::runtime_error for errors of the server.
int run_publish(const PublishOptions& options);

}  // namespace orchard::cli
