// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "io/config/config.hpp"

namespace orchard::cli {

/// Reads a rig's YAML and prints renamed and fixed keys to stderr. Throws io::ConfigError.
io::Config load_rig(const std::string& path);

}  // namespace orchard::cli
