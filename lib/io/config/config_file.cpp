// SPDX-License-Identifier: BSD-3-Clause
#include "io/config/config_file.hpp"

#include <fmt/format.h>

#include <utility>

namespace orchard::io {

ConfigError::ConfigError(std::vector<std::string> problems)
    : std::runtime_error(fmt::to_string(fmt::join(problems, "\n"))),
      problems_(std::move(problems)) {}

}  // namespace orchard::io
