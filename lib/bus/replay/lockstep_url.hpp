// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::bus {

/// Returns the URL for a lockstep replay on the given LCM network: the same address with the port
/// plus 10,000 (minus 10,000 where that exceeds the port range). A live system on the same port
/// would send the messages that the replay waits for, and they cannot be told apart. URLs other
/// than udpm:// are returned unchanged.
std::string lockstep_url(const std::string& lcm_url);

}  // namespace orchard::bus
