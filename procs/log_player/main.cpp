// SPDX-License-Identifier: BSD-3-Clause
#include "bus/process/process.hpp"
#include "log_player/player.hpp"

int main(int argc, char** argv) {
  orchard::procs::PlayerOptions options;
  if (const auto code = orchard::procs::read_player_options(argc, argv, options)) return *code;
  return orchard::bus::run_guarded("orchard-log-player",
                                   [&] { return orchard::procs::play(options); });
}
