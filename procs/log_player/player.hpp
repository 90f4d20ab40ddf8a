// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bus/node/process_options.hpp"
#include "bus/replay/in_process_replay.hpp"
#include "io/config/config.hpp"

namespace orchard::procs {

enum class PlayerMode { kInProcess, kLockstep, kPaced };

/// Command line of orchard-log-player.
struct PlayerOptions {
  PlayerMode mode = PlayerMode::kInProcess;
  std::string log_path;
  std::string out_path;  ///< empty: do not write derived messages
  bool verify = false;
  bus::ReplayOptions replay;                                     ///< strict, from_s, to_s
  std::vector<std::string> nodes{"detector", "pose", "mapper"};  ///< lockstep
  int start_timeout_s = 60;                                      ///< lockstep
  io::RigFile rig;
  bus::ProcessOptions process;  ///< speed, wait_for and hold when paced
};

/// Parses the command line. Returns the exit code if the program must end here.
std::optional<int> read_player_options(int argc, char** argv, PlayerOptions& options);

/// Replays a log and prints numbers of messages read, made and lost. Returns the exit code. Throws
/// io::FileError, bus::BusError, bus::LockstepError.
int play(const PlayerOptions& options);

}  // namespace orchard::procs
