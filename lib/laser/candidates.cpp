// SPDX-License-Identifier: BSD-3-Clause
#include "laser/candidates.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "geometry/angles.hpp"
#include "laser/tuning.hpp"

namespace orchard::laser {
namespace {

/// physical: ranges below this are error codes (SCIP 2.0: 0 to 19 mm).
constexpr float kErrorCodes_m = 0.02f;

}  // namespace

Beams::Beams(const Scan& scan, const SegmentationConfig& config)
    : config_(config),
      size_(static_cast<std::ptrdiff_t>(scan.ranges_m.size())),
      step_rad_(std::abs(scan.bearing_step_rad)),
      step_{std::cos(step_rad_), std::sin(step_rad_)} {
  const double turn_rad = step_rad_ * static_cast<double>(size_);
  is_turn_ = size_ > 2 && std::abs(turn_rad - 2.0 * geometry::kPi) <= 1.5 * step_rad_;
  validate(scan);
  if (config.reflector != ReflectorUse::kIgnored && scan.has_intensities()) find_bright(scan);
  if (is_turn_) start_ = first_gap();
}

void Beams::validate(const Scan& scan) {
  const double nearest_m =
      std::max({scan.range_min_m, config_.range_min_m, static_cast<double>(kErrorCodes_m)});
  const double farthest_m = std::min(scan.range_max_m, config_.range_max_m);
  ranges_m_.assign(scan.ranges_m.size(), 0.0f);
  blocked_.assign(scan.ranges_m.size(), 0);
  const BlindSector blind_sector = config_.blind_sector();
  const bool has_blind = blind_sector.half_width_rad > 0.0;
  const float no_return_m = static_cast<float>(scan.range_max_m);
  for (std::size_t i = 0; i < ranges_m_.size(); ++i) {
    const float range_m = scan.ranges_m[i];
    if (has_blind && blind_sector.contains(scan.bearing_rad(static_cast<double>(i)))) {
      blocked_[i] = 1;
    } else if (range_m >= nearest_m && range_m <= farthest_m && range_m != no_return_m) {
      ranges_m_[i] = range_m;
    } else if (range_m >= kErrorCodes_m && range_m != no_return_m) {
      // Not NaN, an error code, or the maximum range, which some drivers send for no return.
      // A surface that continues just beyond the maximum range has no visible end there.
      const bool cut_off = range_m > farthest_m && range_m <= farthest_m + jump_m(farthest_m);
      blocked_[i] = cut_off || range_m < nearest_m;
    }
  }
}

void Beams::find_bright(const Scan& scan) {
  bright_.assign(ranges_m_.size(), 0);
  for (std::size_t i = 0; i < ranges_m_.size(); ++i) {
    // a comparison with NaN is false
    if (!(ranges_m_[i] > 0.0f && scan.intensities[i] >= config_.reflectivity_min)) continue;
    bright_[i] = 1;
    has_bright_ = true;
  }
}

std::ptrdiff_t Beams::first_gap() const {
  const auto at = [&](std::ptrdiff_t i) {
    return ranges_m_[static_cast<std::size_t>((i % size_ + size_) % size_)];
  };
  constexpr std::ptrdiff_t across = 2;  // one missing beam inside an object is bridged
  const auto is_gap = [&](std::ptrdiff_t i) {
    for (std::ptrdiff_t before = 1; before <= across; ++before) {
      for (std::ptrdiff_t after = 0; before + after <= across; ++after) {
        if (joined(at(i - before), at(i + after))) return false;
      }
    }
    return true;
  };
  for (std::ptrdiff_t i = 0; i < size_; ++i) {
    if (is_gap(i)) return i;
  }
  return 0;
}

namespace {

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
  const double max_m = limb_m + tuning::kBorderNoiseFraction * beams.jump_m(range_m);
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
  const auto most = static_cast<std::size_t>(candidate.last - candidate.first + 1);
  for (std::vector<double>* values : {&arc.ranges_m, &arc.cosines, &arc.sines}) {
    values->resize(most);
  }
  std::size_t num = 0;
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
    arc.ranges_m[num] = beams.range_m(i);
    arc.cosines[num] = c;
    arc.sines[num++] = s;
  });
  for (std::vector<double>* values : {&arc.ranges_m, &arc.cosines, &arc.sines}) {
    values->resize(num);
  }
  const double last = static_cast<double>(candidate.last - candidate.first);
  arc.low_side_rad = -sides.before.beyond_beams * step_rad;
  arc.high_side_rad = (last + sides.after.beyond_beams) * step_rad;
  arc.low_side_sd_rad = sides.before.hidden ? 0.0 : sides.before.sd_beams * step_rad;
  arc.high_side_sd_rad = sides.after.hidden ? 0.0 : sides.after.sd_beams * step_rad;
}

namespace {

/// derived: convergence threshold of good(); coarse, because chi2 converges before the circle's
/// position.
constexpr double kSettled_m = 1e-4;

/// Whether two candidates with the same first beam have the same beams and sides.
bool same(const Candidate& a, const Candidate& b) {
  return a.last == b.last && a.touches_before == b.touches_before &&
         a.touches_after == b.touches_after && a.hidden_before == b.hidden_before &&
         a.hidden_after == b.hidden_after;
}

}  // namespace

CandidateFitter::CandidateFitter(const Beams& beams, const SegmentationConfig& config,
                                 const LaserConfig& laser)
    : beams_(beams),
      config_(config),
      laser_(laser),
      last_known_(static_cast<std::size_t>(beams.size()), -1) {}

const Arc& CandidateFitter::arc(const Candidate& candidate) {
  arc_of(beams_, candidate, sides_of(beams_, candidate, laser_), arc_);
  return arc_;
}

const std::optional<CircleFit>& CandidateFitter::any(const Candidate& candidate) {
  std::int32_t& last = last_known_[static_cast<std::size_t>(candidate.first)];
  if (last < 0 || !same(known_[static_cast<std::size_t>(last)].candidate, candidate)) {
    last = static_cast<std::int32_t>(known_.size());
    known_.push_back({candidate, fit_circle(arc(candidate), beams_.step_rad(),
                                            range_sd_m(candidate), config_.width_max_m)});
  }
  return known_[static_cast<std::size_t>(last)].circle;
}

std::optional<CircleFit> CandidateFitter::operator()(const Candidate& candidate) {
  const std::optional<CircleFit>& circle = any(candidate);
  if (!circle || circle->radius_m >= 0.5 * config_.width_max_m) return std::nullopt;
  return circle;
}

std::optional<CircleFit> CandidateFitter::good(const Candidate& candidate,
                                               const std::optional<CircleFit>& near,
                                               const std::optional<RadiusPrior>& prior) {
  auto circle = fit_circle(arc(candidate), beams_.step_rad(), range_sd_m(candidate),
                           0.5 * config_.width_max_m, {near, kSettled_m, true, prior});
  if (!fits(circle)) circle.reset();
  return circle;
}

}  // namespace orchard::laser
