// SPDX-License-Identifier: BSD-3-Clause
#include "laser/sides.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::laser {
namespace {

Side side_at(const Beams& beams, std::ptrdiff_t end, std::ptrdiff_t outwards, bool touches,
             const LaserConfig& laser) {
  Side side;
  if (touches) {
    side.sd_beams = 1.0;
    return side;
  }
  if (beams.blocked(end + outwards)) {
    side.hidden = true;
    return side;
  }
  const double range_m = beams.range_m(end);
  const double spot_beams = laser.spot_at(range_m) / (range_m * beams.step_rad());
  side.beyond_beams -= 0.5 * spot_beams;
  const auto nearer = [&](std::ptrdiff_t k) {
    const double outside_m = beams.range_around_m(end + k * outwards);
    return outside_m > 0.0 && outside_m < range_m - beams.jump_m(outside_m);
  };
  const double next_m = beams.range_around_m(end + outwards);
  // A range between object and background: the spot lies on both, the beam's axis on the edge.
  const double after_m = beams.range_around_m(end + 2 * outwards);
  if (spot_beams > 0.0 && next_m > range_m && after_m > next_m + beams.jump_m(next_m)) {
    side.beyond_beams = 1.0;
    side.sd_beams = std::max(side.sd_beams, 0.25 * spot_beams);
    return side;
  }
  if (next_m > range_m + beams.jump_m(range_m)) return side;  // free side: background visible
  // One beam between the two objects may be a mixed pixel or missing.
  side.hidden = nearer(1) || nearer(2);
  return side;
}

}  // namespace

Sides sides_of(const Beams& beams, const Candidate& candidate, const LaserConfig& laser) {
  Sides sides{side_at(beams, candidate.first, -1, candidate.touches_before, laser),
              side_at(beams, candidate.last, 1, candidate.touches_after, laser)};
  sides.before.hidden = sides.before.hidden || candidate.hidden_before;
  sides.after.hidden = sides.after.hidden || candidate.hidden_after;
  return sides;
}

void arc_of(const Beams& beams, const Candidate& candidate, const Sides& sides, Arc& arc) {
  const double step_rad = beams.step_rad();
  arc.ranges_m.clear();
  arc.cosines.clear();
  arc.sines.clear();
  // Rotated from beam to beam: cheaper than sin and cos of each; the error is 1e-13 after 1000.
  double c = 1.0, s = 0.0;
  const Direction& step = beams.step();
  std::ptrdiff_t at = candidate.first;
  for_each_beam(beams, candidate, [&](std::ptrdiff_t i) {
    for (; at < i; ++at) {
      const double turned_c = c * step.c - s * step.s;
      s = s * step.c + c * step.s;
      c = turned_c;
    }
    arc.ranges_m.push_back(beams.range_m(i));
    arc.cosines.push_back(c);
    arc.sines.push_back(s);
  });
  const double last = static_cast<double>(candidate.last - candidate.first);
  arc.low_side_rad = -sides.before.beyond_beams * step_rad;
  arc.high_side_rad = (last + sides.after.beyond_beams) * step_rad;
  arc.low_side_sd_rad = sides.before.hidden ? 0.0 : sides.before.sd_beams * step_rad;
  arc.high_side_sd_rad = sides.after.hidden ? 0.0 : sides.after.sd_beams * step_rad;
}

}  // namespace orchard::laser
