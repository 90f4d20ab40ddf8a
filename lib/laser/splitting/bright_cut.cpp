// SPDX-License-Identifier: BSD-3-Clause
#include "laser/splitting/bright_cut.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>

namespace orchard::laser {
namespace {

/// Groups adjacent bright beams on one surface; gaps of one missing or dim beam are bridged.
std::vector<Candidate> bright_clusters(const Beams& beams) {
  std::vector<Candidate> clusters;
  for (std::ptrdiff_t i = 0; i < beams.size(); ++i) {
    if (!beams.bright(i)) continue;
    Candidate* last = clusters.empty() ? nullptr : &clusters.back();
    if (last && i - last->last <= 2 && beams.joined(beams.range_m(last->last), beams.range_m(i))) {
      last->last = i;
      ++last->num_beams;
      continue;
    }
    Candidate cluster;
    cluster.first = cluster.last = i;
    cluster.num_beams = 1;
    cluster.is_bright = true;
    clusters.push_back(cluster);
  }
  return clusters;
}

/// The part of a candidate between two positions; none if it has no beam there.
std::optional<Candidate> part_beside(const Beams& beams, const Candidate& whole,
                                     std::ptrdiff_t first, std::ptrdiff_t last) {
  Candidate part = whole;
  part.num_beams = 0;
  for (std::ptrdiff_t i = std::max(first, whole.first); i <= std::min(last, whole.last); ++i) {
    if (!(beams.range_m(i) > 0.0f)) continue;
    if (part.num_beams++ == 0) part.first = i;
    part.last = i;
  }
  if (part.num_beams == 0) return std::nullopt;
  return part;
}

}  // namespace

void cut_at_bright(const Beams& beams, std::vector<Candidate>& candidates,
                   const std::function<bool(const Candidate&)>& is_trunk) {
  for (Candidate& cluster : bright_clusters(beams)) {
    const bool holds = std::any_of(candidates.begin(), candidates.end(), [&](const Candidate& c) {
      return c.first <= cluster.first && c.last >= cluster.last && is_trunk(c);
    });
    if (holds) continue;
    std::vector<Candidate> rest;
    for (const Candidate& candidate : candidates) {
      if (candidate.last < cluster.first || candidate.first > cluster.last) {
        rest.push_back(candidate);
        continue;
      }
      // A remaining part that is farther than the cluster continues behind it.
      if (auto before = part_beside(beams, candidate, candidate.first, cluster.first - 1)) {
        const float range_m = beams.range_m(cluster.first);
        before->touches_after = true;
        before->hidden_after = beams.range_m(before->last) > range_m;
        cluster.touches_before |= beams.joined(beams.range_m(before->last), range_m);
        rest.push_back(*before);
      }
      if (auto after = part_beside(beams, candidate, cluster.last + 1, candidate.last)) {
        const float range_m = beams.range_m(cluster.last);
        after->touches_before = true;
        after->hidden_before = beams.range_m(after->first) > range_m;
        cluster.touches_after |= beams.joined(beams.range_m(after->first), range_m);
        rest.push_back(*after);
      }
    }
    rest.push_back(cluster);
    candidates = std::move(rest);
  }
}

}  // namespace orchard::laser
