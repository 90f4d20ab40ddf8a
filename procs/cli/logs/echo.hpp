// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace orchard::cli {

struct EchoOptions {
  std::string channel;      ///< such as SCAN
  std::string lcm_url;      ///< empty: the rig's, LCM_DEFAULT_URL or the default
  std::string config_path;  ///< of the rig; empty: none
  bool json = false;        ///< one JSON object per line instead of text
  std::int64_t count = 0;   ///< ends after this many messages; 0: at Ctrl-C
};

/// Prints the messages of a channel, one line each, until stopped. Text shortens arrays longer than
/// eight; JSON has them whole, except the bytes of a picture. Returns the exit code.
int run_echo(const EchoOptions& options);

}  // namespace orchard::cli
