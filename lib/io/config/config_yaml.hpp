// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "io/config/config_visitor.hpp"

namespace orchard::io {

/// What becomes of a key that the schema does not have.
enum class UnknownKeys {
  kRefuse,  ///< an error that names the nearest key
  kNote,    ///< ignored and noted: a log holds the configuration of the release that recorded it
};

/// Reads YAML into the configuration that the schema presents; `name` replaces the path in
/// messages. Returns the notes about unknown keys, one line per section. Throws ConfigError listing
/// all errors at once: unknown keys, wrong types, values out of range and violated conditions
/// between keys. Some values may have been changed then.
std::vector<std::string> read_yaml(const std::string& yaml, const std::string& name,
                                   const ConfigSchema& schema,
                                   UnknownKeys unknown = UnknownKeys::kRefuse);

/// Prints all keys with values, units, ranges and meanings as YAML; expert keys are marked.
std::string print_all_keys(const ConfigSchema& schema);

/// The same without the expert keys that are equal in `schema` and `defaults`.
std::string print_user_keys(const ConfigSchema& schema, const ConfigSchema& defaults);

/// Prints all keys with values, without comments.
std::string print_values(const ConfigSchema& schema);

}  // namespace orchard::io
