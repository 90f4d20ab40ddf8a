// SPDX-License-Identifier: BSD-3-Clause
// plan_trials near|far|rectangle FIRST LAST: a grower's plan laid on maps of random orchards, 5 %
// of the trees missing, 2 % extra, 1 % out of place, one row shifted. near: both are georeferenced;
// far: without satellites; rectangle: the same, and the orchard is its own image when turned.
#include <cstdlib>
#include <string>

#include "experiments/json_line.hpp"
#include "unit/mapping/plan/planned_block.hpp"

namespace {
using namespace orchard::mapping;
using orchard::geometry::Pose2;

void run(std::uint64_t seed, bool any_place, bool is_rectangle) {
  Dice dice(seed);
  Planting planting;
  planting.is_rectangle = is_rectangle;
  PlannedBlock b = plant_to_plan(dice, planting);
  Pose2 T{dice.normal(0.7), dice.normal(0.7), dice.normal(0.005)};
  if (any_place) T = {dice.uniform(-50, 50), dice.uniform(-50, 50), dice.uniform(-3.1, 3.1)};
  const DrivenMap map = drive_all(b, T, dice);
  SensorView sensor;
  sensor.reach_m = 8.0;
  const DetectionMap view(map.landmarks, {map.trajectory}, sensor);
  PlanMatchConfig config;
  config.alignment.any_place = any_place;
  PlanMatch match = match_plan(b.plan, map.landmarks, view, config);
  const bool is_laid = match.is_registered(),
             is_ambiguous = match.fit.status == AlignmentStatus::kAmbiguous;
  PlanScore score;
  if (is_laid) score = score_of(b, map, b.plan, match);
  // one of the placements that are offered must be the right one
  bool is_offered = false;
  const std::size_t num_offered = match.fit.placements.size();
  for (std::size_t k = 0; !is_laid && is_ambiguous && k < num_offered && !is_offered; ++k) {
    config.placement = static_cast<int>(k) + 1;
    match = match_plan(b.plan, map.landmarks, view, config);
    const PlanScore offered = score_of(b, map, b.plan, match);
    is_offered = offered.num_misnamed <= 0.01 * offered.num_named;
  }
  orchard::trials::print_json({{"seed", seed},
                               {"laid", is_laid},
                               {"ambiguous", is_ambiguous},
                               {"offered", is_offered},
                               {"named", score.num_named},
                               {"misnamed", score.num_misnamed},
                               {"true", score.num_true},
                               {"false", score.num_false},
                               {"overlooked", score.num_overlooked}});
}
}  // namespace

int main(int argc, char** argv) {
  const std::string mode = argc == 4 ? argv[1] : "";
  if (mode != "near" && mode != "far" && mode != "rectangle") {
    std::fprintf(stderr, "usage: plan_trials near|far|rectangle FIRST LAST\n");
    return 2;
  }
  const std::uint64_t last = std::strtoull(argv[3], nullptr, 10);
  for (std::uint64_t seed = std::strtoull(argv[2], nullptr, 10); seed <= last; ++seed) {
    run(seed, mode != "near", mode == "rectangle");
  }
}
