// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli/logs/simulate.hpp"

namespace orchard::cli {

/// `orchard simulate --scene board`: writes the log for `orchard calibrate laser-camera`. The rig's
/// own `camera` is the truth; there is no map, so --truth and --poses are rejected.
int run_simulate_board(const SimulateOptions& options);

}  // namespace orchard::cli
