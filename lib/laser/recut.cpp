// SPDX-License-Identifier: BSD-3-Clause
#include "laser/recut.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "laser/circle_fit.hpp"
#include "laser/sides.hpp"

namespace orchard::laser {
namespace {

/// A circle whose chi2 per degree of freedom is below this fits.
constexpr double kGoodFit = 3.0;
/// Two circles have three parameters more than one; noise alone gains this much in 1 of 2000, where
/// it has made a valley or a step besides.
constexpr double kClearlyBetter = 18.0;
/// Ranges between two bulges stand out by this many sigmas before circles are tried.
constexpr double kProminence = 2.0;
/// From here on they stand out without a circle through all to compare with.
constexpr double kClearProminence = 8.0;
constexpr int kFewestBeamsOfAPart = 3;
/// Neighbours on one surface differ by more than this many sigmas in 1 of 10^5.
constexpr double kStepSigmas = 4.5;
/// Wider things are no pair of trunks, one behind the other.
constexpr double kWidestPair_m = 1.0;

/// Fits circles to runs with one set of buffers.
class Fitter {
 public:
  Fitter(const Beams& beams, const SegmentationConfig& config, const LaserConfig& laser)
      : beams_(beams), config_(config), laser_(laser) {}

  std::optional<CircleFit> operator()(const Run& run) {
    arc_of(beams_, run, sides_of(beams_, run, config_), arc_);
    return fit_circle(arc_, beams_.step_rad(), laser_.range_sd_at(beams_.range_m(run.first)),
                      0.5 * config_.width_max_m);
  }

 private:
  const Beams& beams_;
  const SegmentationConfig& config_;
  const LaserConfig& laser_;
  Arc arc_;
};

bool fits(const std::optional<CircleFit>& fit) { return fit && fit->chi2_per_dof() < kGoodFit; }

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

/// The part of a run from one beam to another.
Run part_of(const Beams& beams, const Run& run, std::ptrdiff_t first, std::ptrdiff_t last) {
  Run part = run;
  part.first = first;
  part.last = last;
  part.num_fronts = 0;
  for (int k = 0; k < run.num_fronts; ++k) {
    const Run::Front& front = run.fronts[k];
    if (front.first > first && front.last < last) part.fronts[part.num_fronts++] = front;
  }
  part.num_beams = 0;
  for_each_beam(beams, part, [&](std::ptrdiff_t) { ++part.num_beams; });
  return part;
}

/// The beam that stands out farthest between two nearer ones, if it does by more than noise.
struct Valley {
  std::ptrdiff_t position = 0;
  double sigmas = 0.0;
};

class ValleyFinder {
 public:
  std::optional<Valley> operator()(const Beams& beams, const Run& run, double range_sd_m) {
    positions_.clear();
    for_each_beam(beams, run, [&](std::ptrdiff_t i) { positions_.push_back(i); });
    const std::size_t n = positions_.size();
    if (n < 2 * kFewestBeamsOfAPart) return std::nullopt;
    nearest_after_m_.assign(n, std::numeric_limits<float>::infinity());
    for (std::size_t k = n - 1; k-- > 0;) {
      nearest_after_m_[k] = std::min(nearest_after_m_[k + 1], beams.range_m(positions_[k + 1]));
    }
    float nearest_before_m = beams.range_m(positions_[0]);
    double highest_m = kProminence * range_sd_m;
    std::optional<Valley> best;
    for (std::size_t k = 1; k + 1 < n; ++k) {
      const float range_m = beams.range_m(positions_[k]);
      const double prominence_m = range_m - std::max(nearest_before_m, nearest_after_m_[k]);
      if (prominence_m > highest_m) {
        highest_m = prominence_m;
        best = Valley{positions_[k], prominence_m / range_sd_m};
      }
      nearest_before_m = std::min(nearest_before_m, range_m);
    }
    return best;
  }

 private:
  std::vector<std::ptrdiff_t> positions_;
  std::vector<float> nearest_after_m_;
};

/// The beam after which the range changes most, if it does by more than noise and roundness make.
std::optional<std::ptrdiff_t> find_step(const Beams& beams, const Run& run, double range_sd_m) {
  const double spacing_m = beams.range_m(run.first) * beams.step_rad();
  const double radius_m = 0.25 * static_cast<double>(run.last - run.first) * spacing_m;
  // as trim_rim() has it, of half the run: that much a round surface recedes from beam to beam
  const double limb_m = std::min(radius_m, std::sqrt(2.0 * radius_m * spacing_m));
  double highest_m = limb_m + kStepSigmas * std::sqrt(2.0) * range_sd_m;
  std::optional<std::ptrdiff_t> best;
  std::ptrdiff_t before = run.first;
  for_each_beam(beams, run, [&](std::ptrdiff_t i) {
    const double height_m = std::abs(beams.range_m(i) - beams.range_m(before));
    if (height_m > highest_m) {
      highest_m = height_m;
      best = before;
    }
    before = i;
  });
  return best;
}

/// The beam before the first one that returned nothing: where two surfaces meet, both are lost.
std::optional<std::ptrdiff_t> find_gap(const Beams& beams, const Run& run) {
  std::optional<std::ptrdiff_t> before;
  for (std::ptrdiff_t i = run.first + kFewestBeamsOfAPart; i < run.last && !before; ++i) {
    if (beams.range_m(i) <= 0.0f) before = i - 1;
  }
  return before;
}

struct Parting {
  Run before, after;
};

/// Cut after the beam at a position, which is on the run and not its last.
Parting part_at(const Beams& beams, const Run& run, std::ptrdiff_t position) {
  std::ptrdiff_t next = run.last;
  for_each_beam(beams, run, [&](std::ptrdiff_t i) {
    if (i > position) next = std::min(next, i);
  });
  Parting parts{part_of(beams, run, run.first, position), part_of(beams, run, next, run.last)};
  parts.before.touches_after = parts.after.touches_before = true;
  return parts;
}

/// Whether two circles fit clearly better than one, and both well.
bool two_fit_better(const Parting& parts, const Run& run, Fitter& fit, bool without_one) {
  if (std::min(parts.before.num_beams, parts.after.num_beams) < kFewestBeamsOfAPart) return false;
  const auto first = fit(parts.before);
  if (!fits(first)) return false;
  const auto second = fit(parts.after);
  if (!fits(second)) return false;
  const auto one = fit(run);
  return one ? one->chi2 - first->chi2 - second->chi2 > kClearlyBetter : without_one;
}

}  // namespace

void rejoin(const Beams& beams, const SegmentationConfig& config, const LaserConfig& laser,
            std::vector<Run>& runs) {
  if (config.bridge_beams < 1) return;
  Fitter fit(beams, config, laser);
  std::vector<char> taken(runs.size(), 0);
  for (std::size_t k = 0; k < runs.size(); ++k) {
    if (taken[k]) continue;
    for (std::size_t m = k + 1; m < runs.size() && runs[k].num_fronts < Run::kMaxFronts; ++m) {
      const std::ptrdiff_t hidden = runs[m].first - runs[k].last - 1;
      if (hidden > config.bridge_beams) break;
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

void split_touching(const Beams& beams, const SegmentationConfig& config, const LaserConfig& laser,
                    std::vector<Run>& runs) {
  if (!config.split_touching) return;
  Fitter fit(beams, config, laser);
  ValleyFinder find_valley;
  for (std::size_t k = 0; k < runs.size();) {
    const Run run = runs[k];
    const double range_m = beams.range_m(run.first);
    const double span_m = static_cast<double>(run.last - run.first) * beams.step_rad() * range_m;
    const double range_sd_m = laser.range_sd_at(range_m);
    ++k;
    if (span_m > 2.0 * config.width_max_m) continue;
    Parting parts;
    bool is_pair = false;
    if (const auto valley = find_valley(beams, run, range_sd_m)) {
      parts = part_at(beams, run, valley->position);
      is_pair = two_fit_better(parts, run, fit, valley->sigmas > kClearProminence);
    }
    if (!is_pair && span_m < kWidestPair_m) {
      if (const auto gap = find_gap(beams, run)) {
        parts = part_at(beams, run, *gap);
        is_pair = two_fit_better(parts, run, fit, true);
      }
    }
    if (!is_pair && span_m < kWidestPair_m) {
      const auto step = find_step(beams, run, range_sd_m);
      if (!step) continue;
      parts = part_at(beams, run, *step);
      // the nearer one's side shows; the other goes on behind it
      const bool first_is_nearer =
          beams.range_m(parts.before.last) < beams.range_m(parts.after.first);
      (first_is_nearer ? parts.before.touches_after : parts.after.touches_before) = false;
      (first_is_nearer ? parts.after.hidden_before : parts.before.hidden_after) = true;
      is_pair = two_fit_better(parts, run, fit, true);
    }
    if (!is_pair) continue;
    runs[k - 1] = parts.before;
    runs.insert(runs.begin() + static_cast<std::ptrdiff_t>(k), parts.after);
    --k;  // three may touch
  }
}

}  // namespace orchard::laser
