// SPDX-License-Identifier: BSD-3-Clause
#include "laser/cut.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace orchard::laser {
namespace {

/// Share of the separating step that noise alone may make at the rim of an object.
constexpr double kRimNoiseShare = 0.35;

/// Whether beam `i`, joined to both neighbours, is the one beam of a step from one surface to
/// another: the step is as high as one that separates, and flat ground lies on both sides.
bool is_step_between_surfaces(const Beams& beams, std::ptrdiff_t before, std::ptrdiff_t i) {
  if (i + 2 >= beams.size() || before < 1) return false;
  const double low_m = beams.range_m(before);
  const double high_m = beams.range_m(i + 1);
  const double here_m = beams.range_m(i);
  if (high_m <= 0.0f) return false;
  const double step_m = high_m - low_m;
  if (std::abs(step_m) <= beams.jump_m(std::min(low_m, high_m))) return false;
  if ((here_m - low_m) * step_m <= 0.0 || (high_m - here_m) * step_m <= 0.0) return false;
  // what lies within the noise of one surface is on it: both parts behind a twig end in such beams
  const double noise_m = kRimNoiseShare * beams.jump_m(std::min(low_m, high_m));
  const bool on_one = std::abs(here_m - low_m) < noise_m || std::abs(high_m - here_m) < noise_m;
  if (beams.rejoins() && on_one) return false;
  const auto flat = [&](double a_m, double b_m) {
    return a_m <= 0.0 || b_m <= 0.0 || std::abs(a_m - b_m) < 0.25 * std::abs(step_m);
  };
  return flat(beams.range_m(before - 1), low_m) && flat(high_m, beams.range_m(i + 2));
}

/// Takes one beam off an end, `inwards` of which lies the rest; false where it stays.
bool trim_end(const Beams& beams, Run& run, std::ptrdiff_t inwards) {
  if (run.num_beams < 3) return false;
  const bool at_end = inwards < 0;
  const std::ptrdiff_t rim = at_end ? run.last : run.first;
  const std::ptrdiff_t outside = rim - inwards;
  const auto next_on_run = [&](std::ptrdiff_t from) {
    std::ptrdiff_t inner = from + inwards;
    while (beams.range_m(inner) <= 0.0f || run.in_front(inner) ||
           !beams.joined(beams.range_m(from), beams.range_m(inner))) {
      inner += inwards;
      if (inner == (at_end ? run.first : run.last)) break;
    }
    return inner;
  };
  const std::ptrdiff_t inner = next_on_run(rim);
  // a rim that borders on another surface may be mixed with it; before the open sky it is not, but
  // may be something thin of its own beside the object
  const bool alone = beams.range_around_m(outside) <= 0.0f;
  if (alone && !beams.rejoins()) return false;
  const double range_m = beams.range_m(inner);
  const double spacing_m = range_m * beams.step_rad();
  const double radius_m = 0.5 * static_cast<double>(run.last - run.first) * spacing_m;
  // a round surface recedes at its rim by sqrt(2 R s) at most for a beam spacing s
  const double limb_m = std::min(radius_m, std::sqrt(2.0 * radius_m * spacing_m));
  const double most_m = limb_m + kRimNoiseShare * beams.jump_m(range_m);
  const double rise_m = beams.range_m(rim) - range_m;
  const double outside_m = beams.range_around_m(outside) - range_m;
  const bool may_be_mixed = rise_m * outside_m > 0.0 && std::abs(outside_m) > std::abs(rise_m);
  if ((alone || may_be_mixed) && std::abs(rise_m) > most_m) {
    (at_end ? run.last : run.first) = inner;
    --run.num_beams;
    return true;
  }
  // two beams of something thin
  if (!alone || run.num_beams < 5) return false;
  const std::ptrdiff_t second = next_on_run(inner);
  if (std::abs(beams.range_m(inner) - beams.range_m(second)) <= most_m) return false;
  (at_end ? run.last : run.first) = second;
  run.num_beams -= 2;
  return true;
}

}  // namespace

std::vector<Run> cut(const Beams& beams) {
  std::vector<Run> runs;
  std::optional<Run> run;
  const auto close = [&] {
    if (run) runs.push_back(*run);
    run.reset();
  };
  for (std::ptrdiff_t i = 0; i < beams.size(); ++i) {
    const float here_m = beams.range_m(i);
    if (run) {
      const float last_m = beams.range_m(run->last);
      const std::ptrdiff_t gap = i - run->last;
      if (beams.joined(last_m, here_m)) {
        if (gap == 1 && is_step_between_surfaces(beams, run->last, i)) {
          close();
          continue;  // the beam between belongs to neither
        }
        run->last = i;
        ++run->num_beams;
        continue;
      }
      const bool bridgeable = here_m <= 0.0f || (here_m < last_m && i + 1 < beams.size());
      if (gap == 1 && bridgeable && i + 1 < beams.size() &&
          beams.joined(last_m, beams.range_m(i + 1)) &&
          !beams.joined(here_m, beams.range_m(i + 1))) {
        continue;  // one beam missing, or on something thin in front
      }
      close();
    }
    if (here_m > 0.0f) {
      run.emplace();
      run->first = run->last = i;
      run->num_beams = 1;
    }
  }
  close();
  return runs;
}

void trim_rim(const Beams& beams, Run& run) {
  trim_end(beams, run, 1);
  trim_end(beams, run, -1);
}

}  // namespace orchard::laser
