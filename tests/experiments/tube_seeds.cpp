// SPDX-License-Identifier: BSD-3-Clause
// tube_seeds CONFIG FIRST LAST: the paper's tube scene mapped over many seeds.
#include <exception>
#include <string>

#include "experiments/json_line.hpp"
#include "system/tube_scene/tube_scene_run.hpp"

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: tube_seeds CONFIG FIRST LAST\n");
    return 2;
  }
  try {
    const orchard::io::Config config = orchard::io::load_config(argv[1]);
    for (unsigned long seed = std::stoul(argv[2]); seed <= std::stoul(argv[3]); ++seed) {
      const auto map = orchard::test::run_tube_scene(seed, config);
      const auto complaints = orchard::test::shortcomings(map);
      for (const std::string& complaint : complaints) {
        std::fprintf(stderr, "seed %lu: %s\n", seed, complaint.c_str());
      }
      orchard::trials::print_json({{"seed", seed},
                                   {"complaints", complaints.size()},
                                   {"roc", map.roc_mean_trees},
                                   {"se_x_mm", 1e3 * map.se_x_mean_m},
                                   {"se_y_mm", 1e3 * map.se_y_mean_m},
                                   {"rms_mm", 1e3 * map.all.rmse}});
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "tube_seeds: %s\n", error.what());
    return 3;
  }
}
