// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::cli {

struct DoctorOptions {
  std::string lcm_url;      ///< empty: the rig's, LCM_DEFAULT_URL or the default
  std::string config_path;  ///< of the rig; empty: none
  bool json = false;
};

/// Checks this machine for LCM's needs (multicast route, loopback, sockets, buffers, traffic) and
/// prints each finding as OK, WARN or FAIL with the command that fixes it. Returns 0 when nothing
/// failed, 1 otherwise, 2 for an invalid URL.
int run_doctor(const DoctorOptions& options);

}  // namespace orchard::cli
