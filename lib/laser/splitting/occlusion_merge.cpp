// SPDX-License-Identifier: BSD-3-Clause
#include "laser/splitting/occlusion_merge.hpp"

#include <algorithm>

#include "laser/splitting/candidate_fit.hpp"

namespace orchard::laser {
namespace {

/// Whether all beams between two candidates are nearer than both, and one is on another surface.
bool is_foreground_clutter(const Beams& beams, const Candidate& before, const Candidate& after) {
  const float nearest_m = std::min(beams.range_m(before.last), beams.range_m(after.first));
  bool another = false;
  for (std::ptrdiff_t i = before.last + 1; i < after.first; ++i) {
    const float range_m = beams.range_m(i);
    if (range_m <= 0.0f || range_m >= nearest_m) return false;
    another = another || !beams.joined(range_m, nearest_m);
  }
  return another;
}

Candidate joined_candidate(const Candidate& before, const Candidate& after) {
  Candidate candidate = before;
  candidate.last = after.last;
  candidate.num_beams += after.num_beams;
  candidate.foregrounds[candidate.num_foregrounds++] = {before.last + 1, after.first - 1};
  for (int k = 0; k < after.num_foregrounds; ++k)
    candidate.foregrounds[candidate.num_foregrounds++] = after.foregrounds[k];
  return candidate;
}

}  // namespace

void merge_occluded(const Beams& beams, const SegmentationConfig& config, CandidateFitter& fit,
                    std::vector<Candidate>& candidates) {
  if (config.merge_occluded_beams < 1) return;
  std::vector<char> taken(candidates.size(), 0);
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    if (taken[k]) continue;
    for (std::size_t m = k + 1;
         m < candidates.size() && candidates[k].num_foregrounds < Candidate::kMaxForegrounds; ++m) {
      const std::ptrdiff_t hidden = candidates[m].first - candidates[k].last - 1;
      if (hidden > config.merge_occluded_beams) break;
      // A circle fits almost any few distant beams, so each part needs at least as many beams as
      // are hidden.
      if (hidden > std::min(candidates[k].num_beams, candidates[m].num_beams)) continue;
      if (!beams.joined(beams.range_m(candidates[k].last), beams.range_m(candidates[m].first)) ||
          !is_foreground_clutter(beams, candidates[k], candidates[m])) {
        continue;
      }
      const Candidate both = joined_candidate(candidates[k], candidates[m]);
      if (!fits(fit(both))) continue;
      candidates[k] = both;
      taken[m] = 1;
    }
  }
  std::size_t kept = 0;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    if (!taken[k]) candidates[kept++] = candidates[k];
  }
  candidates.resize(kept);
}

}  // namespace orchard::laser
