// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "io/config/config_visitor.hpp"

namespace orchard::io {

/// Reads a configuration's YAML into what the schema presents; `name` stands for the file in
/// messages. Gives warnings, one line each: keys that have another name now, and keys that are none
/// any more. Throws ConfigError naming every unknown key (with its nearest neighbour), wrong type,
/// value out of range and crossed limit at once, and then may have changed some values.
std::vector<std::string> read_yaml(const std::string& yaml, const std::string& name,
                                   const ConfigSchema& schema);

}  // namespace orchard::io
