// SPDX-License-Identifier: BSD-3-Clause
#include "cli/field/field_url.hpp"

#include <cstdio>
#include <cstdlib>

#include "cli/load_rig.hpp"

namespace orchard::cli {

std::string field_url(const std::string& lcm_url, const std::string& config_path) {
  const char* environment = std::getenv("LCM_DEFAULT_URL");
  std::string url = io::LcmConfig().url;
  const char* why = "the default";
  if (!lcm_url.empty()) {
    url = lcm_url;
    why = "--lcm-url";
  } else if (!config_path.empty()) {
    url = load_rig(config_path).lcm.url;
    why = config_path.c_str();
  } else if (environment != nullptr && environment[0] != '\0') {
    url = environment;
    why = "LCM_DEFAULT_URL";
  }
  std::fprintf(stderr, "LCM: %s (%s)\n", url.c_str(), why);
  return url;
}

}  // namespace orchard::cli
