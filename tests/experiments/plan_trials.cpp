// SPDX-License-Identifier: BSD-3-Clause
// Random orchards with their plans: names and deviations. See plan_trials.sh.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "unit/mapping/plan/planned_block.hpp"

namespace {
using namespace orchard::mapping;
using orchard::geometry::Pose2;

struct Tally {
  PlanScore score;
  int num_refused = 0, num_ambiguous = 0, num_wrong = 0, num_chosen = 0;
};

void run(std::uint64_t seed, bool any_place, bool is_rectangle, Tally& tally) {
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
  const auto begin = std::chrono::steady_clock::now();
  PlanMatch match = match_plan(b.plan, map.landmarks, view, config);
  const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (!match.is_registered()) {
    ++tally.num_refused;
    const bool is_ambiguous = match.fit.status == AlignmentStatus::kAmbiguous;
    tally.num_ambiguous += is_ambiguous;
    std::printf("seed %3d: %s (%.1f s)\n", static_cast<int>(seed), match.fit.reason.c_str(), s);
    // one of the placements that are offered must be the right one
    const std::size_t num_offered = match.fit.placements.size();
    for (std::size_t k = 0; is_ambiguous && k < num_offered; ++k) {
      config.placement = static_cast<int>(k) + 1;
      match = match_plan(b.plan, map.landmarks, view, config);
      const PlanScore score = score_of(b, map, b.plan, match);
      if (score.num_misnamed > 0.01 * score.num_named) continue;
      ++tally.num_chosen;
      tally.score.add(score);
      return;
    }
    return;
  }
  const PlanScore score = score_of(b, map, b.plan, match);
  tally.score.add(score);
  tally.num_wrong += score.num_misnamed > 0;
  std::printf(
      "seed %3d: %4d named, %d misnamed; deviations %d found, %d false, %d overlooked (%.1f s)\n",
      static_cast<int>(seed), score.num_named, score.num_misnamed, score.num_true, score.num_false,
      score.num_overlooked, s);
}
}  // namespace

int main(int argc, char** argv) {
  const std::string mode = argc > 1 ? argv[1] : "near";
  const std::uint64_t first = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  const std::uint64_t last = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 50;
  Tally tally;
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    run(seed, mode != "near", mode == "rectangle", tally);
  }
  const PlanScore& s = tally.score;
  std::printf(
      "%s: %d orchards, %d refused (%d ambiguous, of which %d offer the right placement), %d with "
      "a "
      "wrong name; %d of %d names right; deviations: precision %.4f, recall %.4f\n",
      mode.c_str(), static_cast<int>(last - first + 1), tally.num_refused, tally.num_ambiguous,
      tally.num_chosen, tally.num_wrong, s.num_named, s.num_named + s.num_misnamed, s.precision(),
      s.recall());
}
