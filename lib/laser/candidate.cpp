// SPDX-License-Identifier: BSD-3-Clause
#include "laser/candidate.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace orchard::laser {
namespace {

/// Fraction of the separating step that noise alone may cause at the border of an object.
constexpr double kBorderNoiseFraction = 0.35;

/// Whether beam `i`, joined to both neighbours, is a mixed pixel between two surfaces: the step
/// over it separates objects and the ranges on both sides are level.
bool is_step_between_surfaces(const Beams& beams, std::ptrdiff_t before, std::ptrdiff_t i) {
  if (i + 2 >= beams.size() || before < 1) return false;
  const double low_m = beams.range_m(before);
  const double high_m = beams.range_m(i + 1);
  const double here_m = beams.range_m(i);
  if (high_m <= 0.0f) return false;
  const double step_m = high_m - low_m;
  if (std::abs(step_m) <= beams.jump_m(std::min(low_m, high_m))) return false;
  if ((here_m - low_m) * step_m <= 0.0 || (high_m - here_m) * step_m <= 0.0) return false;
  const auto flat = [&](double a_m, double b_m) {
    return a_m <= 0.0 || b_m <= 0.0 || std::abs(a_m - b_m) < 0.25 * std::abs(step_m);
  };
  return flat(beams.range_m(before - 1), low_m) && flat(high_m, beams.range_m(i + 2));
}

/// Removes the beam at one end if it is a mixed pixel; `inwards` (+1, -1) points to the rest.
void trim_end(const Beams& beams, Candidate& candidate, std::ptrdiff_t inwards) {
  if (candidate.num_beams < 3) return;
  const bool at_end = inwards < 0;
  const std::ptrdiff_t border = at_end ? candidate.last : candidate.first;
  const std::ptrdiff_t outside = border - inwards;
  if (beams.range_around_m(outside) <= 0.0f) return;  // no surface that it could be mixed with
  std::ptrdiff_t inner = border + inwards;            // the next beam on the candidate
  while (beams.range_m(inner) <= 0.0f ||
         !beams.joined(beams.range_m(border), beams.range_m(inner))) {
    inner += inwards;
    if (inner == (at_end ? candidate.first : candidate.last)) break;
  }
  const double range_m = beams.range_m(inner);
  const double spacing_m = range_m * beams.step_rad();
  const double radius_m = 0.5 * static_cast<double>(candidate.last - candidate.first) * spacing_m;
  // A round surface of radius R recedes at its border by at most sqrt(2 R s) per beam spacing s.
  const double limb_m = std::min(radius_m, std::sqrt(2.0 * radius_m * spacing_m));
  const double max_m = limb_m + kBorderNoiseFraction * beams.jump_m(range_m);
  const double rise_m = beams.range_m(border) - range_m;
  const double outside_m = beams.range_around_m(outside) - range_m;
  const bool may_be_mixed = rise_m * outside_m > 0.0 && std::abs(outside_m) > std::abs(rise_m);
  if (!may_be_mixed || std::abs(rise_m) <= max_m) return;
  (at_end ? candidate.last : candidate.first) = inner;
  --candidate.num_beams;
}

}  // namespace

std::vector<Candidate> find_candidates(const Beams& beams) {
  std::vector<Candidate> candidates;
  std::optional<Candidate> candidate;
  const auto close = [&] {
    if (candidate) candidates.push_back(*candidate);
    candidate.reset();
  };
  for (std::ptrdiff_t i = 0; i < beams.size(); ++i) {
    const float here_m = beams.range_m(i);
    if (candidate) {
      const float last_m = beams.range_m(candidate->last);
      const std::ptrdiff_t gap = i - candidate->last;
      if (beams.joined(last_m, here_m)) {
        if (gap == 1 && is_step_between_surfaces(beams, candidate->last, i)) {
          close();
          continue;  // a mixed pixel belongs to neither surface
        }
        candidate->last = i;
        ++candidate->num_beams;
        continue;
      }
      const bool bridgeable = here_m <= 0.0f || (here_m < last_m && i + 1 < beams.size());
      if (gap == 1 && bridgeable && i + 1 < beams.size() &&
          beams.joined(last_m, beams.range_m(i + 1)) &&
          !beams.joined(here_m, beams.range_m(i + 1))) {
        continue;  // one beam without return, or on foreground clutter
      }
      close();
    }
    if (here_m > 0.0f) {
      candidate.emplace();
      candidate->first = candidate->last = i;
      candidate->num_beams = 1;
    }
  }
  close();
  return candidates;
}

void trim_border(const Beams& beams, Candidate& candidate) {
  trim_end(beams, candidate, 1);
  trim_end(beams, candidate, -1);
}

}  // namespace orchard::laser
