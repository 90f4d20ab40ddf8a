// SPDX-License-Identifier: BSD-3-Clause
// Compares a map of a pullally_drive recording with where its trunks pile up in the raw scans, and
// with another map of the same drive.
#include <cstdio>
#include <exception>
#include <string>

#include "io/map/map_csv.hpp"
#include "io/recording/recording_folder.hpp"
#include "system/real_recordings/clear_trees.hpp"
#include "system/real_recordings/tree_repeat.hpp"

namespace {

orchard::test::MappedDrive read_drive(const std::string& folder) {
  return {orchard::io::read_map_csv(folder + "/map.csv"),
          orchard::io::read_trajectory_csv(folder + "/trajectory.csv")};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) {
    std::fprintf(stderr, "usage: clear_trees RECORDING_FOLDER MAP_FOLDER [OTHER_MAP]\n");
    return 2;
  }
  try {
    using namespace orchard::test;
    const auto recording = orchard::io::read_recording_folder(argv[1]);
    const auto trees = find_clear_trees(recording);
    const MappedDrive drive = read_drive(argv[2]);
    if (argc == 3) std::fputs(report(trees, compare(trees, drive.map)).c_str(), stdout);
    if (argc == 3) std::fputs(report(tree_scatter(recording, drive, trees)).c_str(), stdout);
    if (argc == 4) {
      std::fputs(report(same_trees(trees, read_drive(argv[3]), drive)).c_str(), stdout);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "clear_trees: %s\n", error.what());
    return 3;
  }
}
