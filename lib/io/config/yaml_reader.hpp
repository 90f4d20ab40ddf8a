// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "io/config/config_visitor.hpp"

namespace orchard::io {

/// Reads YAML into the configuration that the schema presents; `name` replaces the path in
/// messages. Returns warnings about renamed and removed keys, one line each. Throws ConfigError
/// listing all errors at once: unknown keys (with the nearest known one), wrong types, values out
/// of range and violated conditions between keys. Some values may have been changed then.
std::vector<std::string> read_yaml(const std::string& yaml, const std::string& name,
                                   const ConfigSchema& schema);

}  // namespace orchard::io
