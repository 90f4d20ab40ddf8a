// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli/logs/simulate.hpp"

namespace orchard::cli {

/// `orchard simulate --scene board`: the log for `orchard calibrate laser-camera`. The truth is the
/// rig's own `camera`; there is no map, so --truth, --poses and --observations are refused.
int run_simulate_board(const SimulateOptions& options);

}  // namespace orchard::cli
