// SPDX-License-Identifier: BSD-3-Clause
// For people: maps compared and merged over many random blocks, without scans. See --help.
#include "experiments/two_map_trials.hpp"

#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

const char* const kHelp =
    "two_map_trials MODE FIRST_SEED LAST_SEED\n"
    "Blocks of 10 rows of 30 trees (4 m x 2 m, 8 % missing), mapped by drives whose observations, "
    "noise "
    "and\n"
    "slow bends are simulated without scans.\n"
    "  changes  one block before and after changes, and unchanged: what compare finds\n"
    "  ids      one block before and after changes: ids and numbers that are kept\n"
    "  merge    three robots, each in some of the rows and in a frame of its own, as one map\n"
    "Seeds 1 to 1000 are kept for reports, those above for choosing.\n";

}  // namespace

int main(int argc, char** argv) {
  using namespace orchard::trials;
  std::setvbuf(stdout, nullptr, _IOLBF, 4096);  // a long run tells as it goes
  if (argc != 4) {
    std::fputs(kHelp, argc > 1 && std::strcmp(argv[1], "--help") == 0 ? stdout : stderr);
    return argc > 1 && std::strcmp(argv[1], "--help") == 0 ? 0 : 2;
  }
  const Seeds seeds{std::strtoull(argv[2], nullptr, 10), std::strtoull(argv[3], nullptr, 10)};
  if (std::strcmp(argv[1], "changes") == 0) return run_changes(seeds) ? 0 : 1;
  if (std::strcmp(argv[1], "ids") == 0) return run_ids(seeds) ? 0 : 1;
  if (std::strcmp(argv[1], "merge") == 0) return run_merge(seeds) ? 0 : 1;
  std::fputs(kHelp, stderr);
  return 2;
}
