// SPDX-License-Identifier: BSD-3-Clause
#include "cli/load_rig.hpp"

#include <cstdio>
#include <utility>

namespace orchard::cli {

io::Config load_rig(const std::string& path) {
  io::LoadedConfig loaded = io::load_config_with_warnings(path);
  for (const std::string& warning : loaded.warnings) {
    std::fprintf(stderr, "orchard: warning: %s\n", warning.c_str());
  }
  return std::move(loaded.config);
}

}  // namespace orchard::cli
