// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli/field/launch_plan.hpp"

namespace orchard::cli {

/// Starts the processes of this machine, keeps them running, shows how everyone is, and stops them
/// in order at Ctrl-C, so that the map holds all that was measured. Returns 0 when all ended well.
int run_live(const LiveOptions& options);

}  // namespace orchard::cli
