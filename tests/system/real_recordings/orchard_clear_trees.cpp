// SPDX-License-Identifier: BSD-3-Clause
// Compares a map of a pullally_drive recording with where its trunks pile up in the raw scans.
#include <cstdio>
#include <exception>
#include <string>

#include "clear_trees.hpp"
#include "io/map_csv.hpp"
#include "io/recording_folder.hpp"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: orchard_clear_trees RECORDING_FOLDER MAP_FOLDER\n");
    return 2;
  }
  try {
    const auto trees = orchard::test::find_clear_trees(orchard::io::read_recording_folder(argv[1]));
    const auto map = orchard::io::read_map_csv(std::string(argv[2]) + "/map.csv");
    const auto comparison = orchard::test::compare(trees, map);
    std::fputs(orchard::test::report(trees, comparison).c_str(), stdout);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "orchard_clear_trees: %s\n", error.what());
    return 3;
  }
}
