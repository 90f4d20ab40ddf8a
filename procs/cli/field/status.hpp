// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::cli {

struct StatusOptions {
  std::string lcm_url;
  std::string config_path;
  bool once = false;
  bool json = false;
};

/// Shows all processes of all hosts until Ctrl-C. `once`: prints them after 2.5 s and returns 1
/// when one needs attention or none was heard.
int run_status(const StatusOptions& options);

}  // namespace orchard::cli
