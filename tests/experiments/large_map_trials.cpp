// SPDX-License-Identifier: BSD-3-Clause
// large_map_trials TREES FIRST LAST: two maps of a large block, each in a frame of its own, laid on
// each other. Blocks of so many trees (4 m x 2 m, 8 % missing) before and after one tree in twenty
// came or went, mapped by two drives simulated without scans: of the whole block or, with odd
// seeds, of one half while the first drove three quarters. Every fifth seed lays a map of another
// block upon the first: that must be refused.
#include <cmath>
#include <cstdlib>
#include <ctime>

#include "experiments/json_line.hpp"
#include "mapping/compare/map_alignment.hpp"
#include "unit/mapping/compare/large_block.hpp"

namespace {

using namespace orchard;
using namespace orchard::mapping;

constexpr double kWrong_m = 0.5;  ///< an alignment that puts a tree farther off is wrong

void run(int num_trees, std::uint64_t seed) {
  Dice dice(seed);
  const int num_rows = std::max(4, static_cast<int>(std::sqrt(num_trees / 13.75)));
  const int num_places = static_cast<int>(num_trees / 0.92 / num_rows);
  Block block = plant_block(dice, num_rows, num_places);
  const double length_m = num_places * block.tree_spacing_m;
  const bool is_other = seed % 5 == 0;
  const bool is_part = seed % 2 == 1;
  Drive first, second;
  first.along_max_m = second.along_max_m = length_m + 1.0;
  first.last_aisle = second.last_aisle = num_rows;
  if (is_part) {
    first.last_aisle = 3 * num_rows / 4;
    second.first_aisle = num_rows / 2;
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
  const bool is_registered = alignment.status == AlignmentStatus::kAligned;
  double error_m = 0.0;
  const geometry::Pose2 T_a_b = inverse(second.T_map_block);
  for (const Landmark& l : b.landmarks) {
    const Eigen::Vector2d p(l.x_m, l.y_m);
    error_m = std::max(error_m, (transform(alignment.T_a_b, p) - transform(T_a_b, p)).norm());
  }
  orchard::trials::print_json({{"seed", seed},
                               {"other", is_other},
                               {"refused", !is_registered},
                               {"right", is_registered && !is_other && error_m <= kWrong_m},
                               {"error_m", error_m},
                               {"took_s", took_s}});
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: large_map_trials TREES FIRST LAST\n");
    return 2;
  }
  const std::uint64_t last = std::strtoull(argv[3], nullptr, 10);
  for (std::uint64_t seed = std::strtoull(argv[2], nullptr, 10); seed <= last; ++seed) {
    run(std::atoi(argv[1]), seed);
  }
  return 0;
}
