// SPDX-License-Identifier: BSD-3-Clause
#include "cli/field/field_url.hpp"

#include <cstdio>

#include "bus/node/process_options.hpp"
#include "io/config/config.hpp"

namespace orchard::cli {

std::string field_url(const std::string& lcm_url, const std::string& config_path) {
  io::LcmConfig lcm;
  const bool has_rig = !config_path.empty() && lcm_url.empty();
  if (has_rig) lcm = io::load_config(config_path).lcm;
  const char* why = bus::choose_url(lcm_url, has_rig, lcm);
  std::fprintf(stderr, "LCM: %s (%s)\n", lcm.url.c_str(), has_rig ? config_path.c_str() : why);
  return lcm.url;
}

}  // namespace orchard::cli
