// SPDX-License-Identifier: BSD-3-Clause
#include "laser/splitting/rejoin.hpp"

#include <algorithm>

#include "laser/splitting/run_fit.hpp"

namespace orchard::laser {
namespace {

/// Whether all beams between two runs are nearer, and one is on another surface.
bool is_thin_front(const Beams& beams, const Run& before, const Run& after) {
  const float nearest_m = std::min(beams.range_m(before.last), beams.range_m(after.first));
  bool another = false;
  for (std::ptrdiff_t i = before.last + 1; i < after.first; ++i) {
    const float range_m = beams.range_m(i);
    if (range_m <= 0.0f || range_m >= nearest_m) return false;
    another = another || !beams.joined(range_m, nearest_m);
  }
  return another;
}

Run joined_run(const Run& before, const Run& after) {
  Run run = before;
  run.last = after.last;
  run.num_beams += after.num_beams;
  run.fronts[run.num_fronts++] = {before.last + 1, after.first - 1};
  for (int k = 0; k < after.num_fronts; ++k) run.fronts[run.num_fronts++] = after.fronts[k];
  return run;
}

}  // namespace

void rejoin(const Beams& beams, const SegmentationConfig& config, RunFitter& fit,
            std::vector<Run>& runs) {
  if (config.merge_occluded_beams < 1) return;
  std::vector<char> taken(runs.size(), 0);
  for (std::size_t k = 0; k < runs.size(); ++k) {
    if (taken[k]) continue;
    for (std::size_t m = k + 1; m < runs.size() && runs[k].num_fronts < Run::kMaxFronts; ++m) {
      const std::ptrdiff_t hidden = runs[m].first - runs[k].last - 1;
      if (hidden > config.merge_occluded_beams) break;
      // a circle fits whatever few beams lie far apart: what is joined must show more than it lacks
      if (hidden > std::min(runs[k].num_beams, runs[m].num_beams)) continue;
      if (!beams.joined(beams.range_m(runs[k].last), beams.range_m(runs[m].first)) ||
          !is_thin_front(beams, runs[k], runs[m])) {
        continue;
      }
      const Run both = joined_run(runs[k], runs[m]);
      if (!fits(fit(both))) continue;
      runs[k] = both;
      taken[m] = 1;
    }
  }
  std::size_t kept = 0;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    if (!taken[k]) runs[kept++] = runs[k];
  }
  runs.resize(kept);
}

}  // namespace orchard::laser
