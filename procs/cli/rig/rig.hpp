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
[[gnu::weak]] int run_doctor(const DoctorOptions& options);

/// `orchard overlay LOG --at TIME --out PNG`.
struct OverlayOptions {
  std::string log_path;
  double at = 0.0;          ///< seconds from the log's first message, or an absolute utime [us]
  std::string config_path;  ///< empty: the rig stored in the log
  std::string out_path;
};

/// Draws the scan points and the detector's results onto the picture nearest to a time; returns the
/// exit code. Throws io::FileError and io::ConfigError, and then writes nothing.
[[gnu::weak]] int run_overlay(const OverlayOptions& options);

}  // namespace orchard::cli
