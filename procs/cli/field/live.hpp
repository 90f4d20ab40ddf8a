// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli/field/launch_plan.hpp"

namespace orchard::cli {

/// Starts the processes of this machine, keeps them running, and shows their status. At Ctrl-C
/// stops them in order, so that the map contains all measurements. Returns 0 when all ended without
/// error.
int run_live(const LiveOptions& options);

}  // namespace orchard::cli
