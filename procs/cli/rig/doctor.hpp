// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::cli {

struct DoctorOptions {
  std::string lcm_url;      ///< empty: the rig's, LCM_DEFAULT_URL or the default
  std::string config_path;  ///< of the rig; empty: none
  bool json = false;
};

/// Looks at what LCM needs of this machine (multicast route, loopback, sockets, buffers, traffic)
/// and prints each finding as OK, WARN or FAIL with the command that mends it. Returns 0 when
/// nothing failed, 1 otherwise, 2 for a URL it cannot read.
int run_doctor(const DoctorOptions& options);

}  // namespace orchard::cli
