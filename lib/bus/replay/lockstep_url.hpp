// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::bus {

/// Where a lockstep replay on that LCM network takes place: the same address, 10,000 ports on (or
/// back, at the end of them). A live system beside it sends the very messages that a replay waits
/// for, and nothing in them tells the two apart. Other URLs than udpm:// stay as they are.
std::string lockstep_url(const std::string& lcm_url);

}  // namespace orchard::bus
