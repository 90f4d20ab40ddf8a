// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::bench {

/// Moves this process, and every child it starts afterwards, into a network of its own: nothing
/// but lo, with multicast. To be called before any thread exists. Returns why it did not work, or
/// an empty text.
std::string enter_private_network();

}  // namespace orchard::bench
