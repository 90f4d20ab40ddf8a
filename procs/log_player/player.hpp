// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "log_player/player_options.hpp"

namespace orchard::procs {

/// Replays a log and prints numbers of messages read, made and lost. Returns the exit code. Throws
/// io::FileError, bus::BusError, bus::LockstepError.
int play(const PlayerOptions& options);

}  // namespace orchard::procs
