// SPDX-License-Identifier: BSD-3-Clause
#include <exception>
#include <iostream>

#include "bus/process/process.hpp"
#include "io/file_error.hpp"
#include "log_player/player.hpp"

int main(int argc, char** argv) {
  orchard::procs::PlayerOptions options;
  if (const auto code = orchard::procs::read_player_options(argc, argv, options)) return *code;
  try {
    return orchard::procs::play(options);
  } catch (const orchard::io::FileError& error) {
    std::cerr << "orchard-log-player: " << error.what() << "\n";
    return orchard::bus::kExitInput;
  } catch (const orchard::io::ConfigError& error) {
    std::cerr << "orchard-log-player: " << error.what() << "\n";
    return orchard::bus::kExitInput;
  } catch (const std::exception& error) {
    std::cerr << "orchard-log-player: " << error.what() << "\n";
    return orchard::bus::kExitRuntime;
  }
}
