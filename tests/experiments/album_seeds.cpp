// SPDX-License-Identifier: BSD-3-Clause
// For people: tests/experiments/album_seeds.sh. Has every tree a photograph, and is its trunk in
// the middle?
#include <cstdio>
#include <cstdlib>
#include <exception>

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
    std::printf("seed  trees  mapped  photographed  centred  as_in_picture  kB\n");
    long mapped = 0, photographed = 0, centred = 0;
    for (unsigned long seed = first; seed <= last; ++seed) {
      const auto o = orchard::test::run_album(config, seed, "");
      std::printf("%4lu  %5d  %6d  %12d  %7d  %13d  %.0f\n", seed, o.num_true_trees, o.num_trees,
                  o.num_photographed, o.num_centred, o.num_same, 1e-3 * o.num_bytes);
      std::fflush(stdout);
      mapped += o.num_trees, photographed += o.num_photographed, centred += o.num_centred;
    }
    const double of = 100.0 / static_cast<double>(mapped > 0 ? mapped : 1);
    std::printf(
        "all: %ld trees mapped, %.2f %% photographed, %.2f %% with the trunk in the middle\n",
        mapped, of * photographed, of * centred);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "album_seeds: %s\n", error.what());
    return 1;
  }
  return 0;
}
