// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "io/config/config_visitor.hpp"

namespace orchard::io {

/// All keys with values, units, ranges and meanings, as YAML; those for experts are marked so.
std::string print_all_keys(const ConfigSchema& schema);

/// The same without the keys for experts that are equal in `schema` and `defaults`.
std::string print_user_keys(const ConfigSchema& schema, const ConfigSchema& defaults);

/// All keys with values, without comments.
std::string print_values(const ConfigSchema& schema);

}  // namespace orchard::io
