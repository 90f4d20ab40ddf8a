// SPDX-License-Identifier: BSD-3-Clause
// For people: two maps of a large block, each in a frame of its own, laid on each other. See
// --help.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string>

#include "mapping/compare/map_alignment.hpp"
#include "unit/mapping/compare/large_block.hpp"

namespace {

using namespace orchard;
using namespace orchard::mapping;

const char* const kHelp =
    "large_map_trials TREES FIRST_SEED LAST_SEED\n"
    "Blocks of so many trees (4 m x 2 m, 8 % missing) before and after one tree in twenty came or\n"
    "went, mapped by two drives whose noise and slow bends are simulated without scans, the "
    "second\n"
    "in any frame: of the whole block, or, with odd seeds, of one half while the first drove "
    "three\n"
    "quarters. Every fifth seed lays a map of another block upon the first: that must be refused.\n"
    "Prints the processor time of --any-place, and whether it was right.\n"
    "Seeds 1 to 1000 are kept for reports, those above for choosing.\n";

constexpr double kWrong_m = 0.5;  ///< an alignment that puts a tree farther off is wrong

struct Tally {
  int num_right = 0, num_refused = 0, num_wrong = 0, num_others = 0, num_others_laid = 0;
  double worst_s = 0.0, sum_s = 0.0;
};

DetectionMap view_of(const DrivenMap& map) {
  SensorView view;
  view.reach_m = 8.0;
  return DetectionMap(map.landmarks, {map.trajectory}, view);
}

void run(int num_trees, std::uint64_t seed, Tally& tally) {
  Dice dice(seed);
  const int num_rows = std::max(4, static_cast<int>(std::sqrt(num_trees / 13.75)));
  const int num_places = static_cast<int>(num_trees / 0.92 / num_rows);
  Block block = plant_block(dice, num_rows, num_places);
  const double length_m = num_places * block.tree_spacing_m;
  const bool is_other = seed % 5 == 0;
  const bool is_part = seed % 2 == 1;
  Drive first, second;
  first.along_max_m = second.along_max_m = length_m + 1.0;
  first.last_alley = second.last_alley = num_rows;
  if (is_part) {
    first.last_alley = 3 * num_rows / 4;
    second.first_alley = num_rows / 2;
  }
  second.T_map_block = {dice.uniform(-500, 500), dice.uniform(-500, 500), dice.uniform(-3.1, 3.1)};
  const DrivenMap a = drive_through_large(block, first, dice);
  if (is_other) block = plant_block(dice, num_rows, num_places);
  for (TrueTree& t : block.trees) {
    if (dice.uniform(0, 1) < 0.05) t.stands = !t.stands;
  }
  const DrivenMap b = drive_through_large(block, second, dice);
  const DetectionMap view_a = view_of(a), view_b = view_of(b);
  MapAlignmentConfig config;
  config.any_place = true;
  const std::clock_t begin = std::clock();
  const MapAlignment alignment = align_maps(a.landmarks, b.landmarks, view_a, view_b, config);
  const double took_s = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  tally.worst_s = std::max(tally.worst_s, took_s);
  tally.sum_s += took_s;
  const bool is_registered = alignment.status == AlignmentStatus::kAligned;
  double error_m = 0.0;
  const geometry::Pose2 T_a_b = inverse(second.T_map_block);
  for (const Landmark& l : b.landmarks) {
    const Eigen::Vector2d p(l.x_m, l.y_m);
    error_m = std::max(error_m, (transform(alignment.T_a_b, p) - transform(T_a_b, p)).norm());
  }
  std::string verdict = is_registered ? error_m > kWrong_m ? "WRONG" : "right" : "refused";
  if (is_other) {
    ++tally.num_others;
    tally.num_others_laid += is_registered;
    verdict = is_registered ? "another block LAID" : "another block refused";
  } else {
    ++(!is_registered ? tally.num_refused : error_m > kWrong_m ? tally.num_wrong : tally.num_right);
  }
  std::printf("seed %llu: %zu and %zu trees, %.1f s: %s, %zu pairs, %.2f m%s%s\n",
              static_cast<unsigned long long>(seed), a.landmarks.size(), b.landmarks.size(), took_s,
              verdict.c_str(), alignment.pairs.size(), is_registered ? error_m : 0.0,
              is_registered ? "" : ": ", is_registered ? "" : alignment.reason.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  std::setvbuf(stdout, nullptr, _IOLBF, 4096);  // a long run tells as it goes
  const bool wants_help = argc > 1 && std::strcmp(argv[1], "--help") == 0;
  if (argc != 4) {
    std::fputs(kHelp, wants_help ? stdout : stderr);
    return wants_help ? 0 : 2;
  }
  Tally tally;
  const std::uint64_t last = std::strtoull(argv[3], nullptr, 10);
  std::uint64_t num = 0;
  for (std::uint64_t seed = std::strtoull(argv[2], nullptr, 10); seed <= last; ++seed, ++num) {
    run(std::atoi(argv[1]), seed, tally);
  }
  std::printf(
      "%d right, %d refused, %d wrong; of another block %d of %d laid; %.1f s, at most %.1f s\n",
      tally.num_right, tally.num_refused, tally.num_wrong, tally.num_others_laid, tally.num_others,
      tally.sum_s / static_cast<double>(std::max<std::uint64_t>(1, num)), tally.worst_s);
  return tally.num_wrong + tally.num_others_laid == 0 ? 0 : 1;
}
