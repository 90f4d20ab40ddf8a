// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::cli {

/// Selects the LCM network: --lcm-url when given, else the rig's, else LCM_DEFAULT_URL, else the
/// built-in one. Prints the choice and its reason on standard error. Throws io::ConfigError.
std::string field_url(const std::string& lcm_url, const std::string& config_path);

}  // namespace orchard::cli
