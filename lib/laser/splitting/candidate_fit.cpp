// SPDX-License-Identifier: BSD-3-Clause
#include "laser/splitting/candidate_fit.hpp"

#include <cstddef>

namespace orchard::laser {
namespace {

/// Convergence threshold of good(); coarse, because chi2 converges before the circle's position.
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
