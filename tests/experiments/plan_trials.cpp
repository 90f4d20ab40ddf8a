// SPDX-License-Identifier: BSD-3-Clause
// plan_trials FIRST LAST: a grower's plan laid on maps of random orchards, 5 % of the trees
// missing, 2 % extra, 1 % out of place, one row shifted; both are georeferenced, 0.7 m and 0.3
// degrees apart.
#include <cstdlib>
#include <string>

#include "experiments/json_line.hpp"
#include "unit/mapping/plan/planned_block.hpp"

namespace {
using namespace orchard::mapping;
using orchard::geometry::Pose2;

void run(std::uint64_t seed) {
  Dice dice(seed);
  PlannedBlock b = plant_to_plan(dice, {});
  const Pose2 T{dice.normal(0.7), dice.normal(0.7), dice.normal(0.005)};
  const DrivenMap map = drive_all(b, T, dice);
  SensorView sensor;
  sensor.reach_m = 8.0;
  const DetectionMap view(map.landmarks, {map.trajectory}, sensor);
  PlanMatchConfig config;
  config.alignment.any_place = false;
  const PlanMatch match = match_plan(b.plan, map.landmarks, view, config);
  PlanScore score;
  if (match.is_registered()) score = score_of(b, map, b.plan, match);
  orchard::trials::print_json({{"seed", seed},
                               {"laid", match.is_registered()},
                               {"named", score.num_named},
                               {"misnamed", score.num_misnamed},
                               {"true", score.num_true},
                               {"false", score.num_false},
                               {"overlooked", score.num_overlooked}});
}
}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: plan_trials FIRST LAST\n");
    return 2;
  }
  const std::uint64_t last = std::strtoull(argv[2], nullptr, 10);
  for (std::uint64_t seed = std::strtoull(argv[1], nullptr, 10); seed <= last; ++seed) run(seed);
}
