// SPDX-License-Identifier: BSD-3-Clause
// album_seeds RIG FIRST LAST: has every tree a photograph, and is its trunk in the middle?
#include <cstdlib>
#include <exception>

#include "experiments/json_line.hpp"
#include "system/album/album_run.hpp"

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: album_seeds RIG FIRST_SEED LAST_SEED\n");
    return 2;
  }
  try {
    const auto config = orchard::io::load_config(argv[1]);
    const unsigned long first = std::strtoul(argv[2], nullptr, 10);
    const unsigned long last = std::strtoul(argv[3], nullptr, 10);
    for (unsigned long seed = first; seed <= last; ++seed) {
      const auto o = orchard::test::run_album(config, seed, "");
      orchard::trials::print_json({{"seed", seed},
                                   {"trees", o.num_true_trees},
                                   {"mapped", o.num_trees},
                                   {"photographed", o.num_photographed},
                                   {"centred", o.num_centred},
                                   {"bytes", o.num_bytes}});
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "album_seeds: %s\n", error.what());
    return 1;
  }
  return 0;
}
