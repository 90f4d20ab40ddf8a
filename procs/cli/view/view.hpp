// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::cli {

/// `orchard view LOG|MAP_FOLDER`.
struct ViewOptions {
  std::vector<std::string> paths;  ///< a map folder, or the logs of one drive
  std::string config_path;         ///< for a log: a rig in place of the recorded one
  std::string listen;              ///< "ADDRESS", "ADDRESS:PORT", ":PORT"
  std::string token_file;
  bool edit = false;  ///< for a map folder: users of the page may correct the map
  bool open = false;  ///< open the page in the user's browser
};

/// Serves the page until Ctrl-C; returns the exit code. Throws io::FileError, io::ConfigError,
/// std::runtime_error.
[[gnu::weak]] int run_view(const ViewOptions& options);

}  // namespace orchard::cli
