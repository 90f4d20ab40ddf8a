// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "io/config/config_visitor.hpp"

namespace orchard::io {

/// Prints all keys with values, units, ranges and meanings as YAML; expert keys are marked.
std::string print_all_keys(const ConfigSchema& schema);

/// The same without the expert keys that are equal in `schema` and `defaults`.
std::string print_user_keys(const ConfigSchema& schema, const ConfigSchema& defaults);

/// Prints all keys with values, without comments.
std::string print_values(const ConfigSchema& schema);

}  // namespace orchard::io
