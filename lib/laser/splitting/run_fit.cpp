// SPDX-License-Identifier: BSD-3-Clause
#include "laser/splitting/run_fit.hpp"

#include <cstddef>

namespace orchard::laser {
namespace {

/// Chi2 is as good as it gets long before the circle stands still.
constexpr double kSettled_m = 1e-4;

/// Whether two runs that begin at the same beam are fitted by the same circle.
bool same(const Run& a, const Run& b) {
  bool alike = a.last == b.last && a.num_fronts == b.num_fronts &&
               a.touches_before == b.touches_before && a.touches_after == b.touches_after &&
               a.hidden_before == b.hidden_before && a.hidden_after == b.hidden_after;
  for (int k = 0; alike && k < a.num_fronts; ++k) {
    alike = a.fronts[k].first == b.fronts[k].first && a.fronts[k].last == b.fronts[k].last;
  }
  return alike;
}

}  // namespace

RunFitter::RunFitter(const Beams& beams, const SegmentationConfig& config, const LaserConfig& laser)
    : beams_(beams),
      config_(config),
      laser_(laser),
      last_known_(static_cast<std::size_t>(beams.size()), -1) {}

const Arc& RunFitter::arc(const Run& run) {
  arc_of(beams_, run, sides_of(beams_, run, config_), arc_);
  return arc_;
}

const std::optional<CircleFit>& RunFitter::any(const Run& run) {
  std::int32_t& last = last_known_[static_cast<std::size_t>(run.first)];
  if (last < 0 || !same(known_[static_cast<std::size_t>(last)].run, run)) {
    last = static_cast<std::int32_t>(known_.size());
    known_.push_back(
        {run, fit_circle(arc(run), beams_.step_rad(), range_sd_m(run), config_.width_max_m)});
  }
  return known_[static_cast<std::size_t>(last)].circle;
}

std::optional<CircleFit> RunFitter::operator()(const Run& run) {
  const std::optional<CircleFit>& circle = any(run);
  if (!circle || circle->radius_m >= 0.5 * config_.width_max_m) return std::nullopt;
  return circle;
}

std::optional<CircleFit> RunFitter::good(const Run& run, const std::optional<CircleFit>& near) {
  auto circle = fit_circle(arc(run), beams_.step_rad(), range_sd_m(run), 0.5 * config_.width_max_m,
                           {near, kSettled_m, true});
  if (!fits(circle)) circle.reset();
  return circle;
}

}  // namespace orchard::laser
