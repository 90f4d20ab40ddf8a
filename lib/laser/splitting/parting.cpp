// SPDX-License-Identifier: BSD-3-Clause
#include "laser/splitting/parting.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "laser/splitting/best_parts.hpp"
#include "laser/splitting/line_fit.hpp"
#include "laser/splitting/run_fit.hpp"
#include "laser/splitting/run_parts.hpp"

namespace orchard::laser {
namespace {

/// Two circles have three parameters more than one; noise alone gains this much in 1 of 2000, where
/// it has made a valley or a step besides.
constexpr double kClearlyBetter = 18.0;
/// Ranges between two bulges stand out by this many sigmas before circles are tried.
constexpr double kProminence = 2.0;
/// From here on they stand out without a circle through all to compare with.
constexpr double kClearProminence = 8.0;
/// Neighbours on one surface differ by more than this many sigmas in 1 of 10^5.
constexpr double kStepSigmas = 4.5;
/// Trees with two stems are narrower, and a scan shows no more beams of them from where it matters.
constexpr double kWidestTwins_m = 0.4;
constexpr int kMostBeamsTried = 40;
/// Wider things are no pair of trunks, one behind the other.
constexpr double kWidestPair_m = 1.0;
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

/// Whether two circles fit clearly better than one, and both well.
bool two_fit_better(const Parting& parts, const Run& run, RunFitter& fit, bool without_one) {
  if (std::min(parts.before.num_beams, parts.after.num_beams) < kFewestBeamsOfAPart) return false;
  const auto first = fit.good(parts.before);
  if (!first) return false;
  const auto second = fit.good(parts.after);
  if (!second) return false;
  const auto one = fit(run);
  return one ? one->chi2 - first->chi2 - second->chi2 > kClearlyBetter : without_one;
}

/// Of a flat piece with a hidden side nobody can tell the circle: any large one fits.
bool is_flat_piece(const Run& run, RunFitter& fit) {
  const Arc& arc = fit.arc(run);
  const bool hidden = arc.low_side_sd_rad == 0.0 || arc.high_side_sd_rad == 0.0;
  return hidden && line_chi2(arc, fit.range_sd_m(run)) < kGoodFit * (run.num_beams - 2);
}

}  // namespace

void split_touching(const Beams& beams, const SegmentationConfig& config, const LaserConfig& laser,
                    RunFitter& fit, std::vector<Run>& runs) {
  if (!config.split_touching) return;
  ValleyFinder find_valley;
  BestParts best_parts(beams, fit);
  for (std::size_t k = 0; k < runs.size();) {
    const Run run = runs[k];
    const double range_m = beams.range_m(run.first);
    const double span_m = static_cast<double>(run.last - run.first) * beams.step_rad() * range_m;
    const double range_sd_m = laser.range_sd_at(range_m);
    ++k;
    if (span_m > 2.0 * config.width_max_m || run.num_beams <= kFewestBeamsOfAPart) continue;
    const auto replace = [&](const std::vector<Run>& parts) {
      runs[k - 1] = parts.front();
      runs.insert(runs.begin() + static_cast<std::ptrdiff_t>(k), parts.begin() + 1, parts.end());
    };
    const bool small = span_m <= kWidestTwins_m && run.num_beams <= kMostBeamsTried;
    if (small && !fits(fit(run))) {
      if (is_flat_piece(run, fit)) continue;
      const std::vector<Run>& parts = best_parts(run);
      if (parts.empty()) continue;
      replace(parts);
      k += parts.size() - 1;
      continue;
    }
    Parting parts;
    bool is_pair = false;
    if (const auto valley = find_valley(beams, run, range_sd_m)) {
      parts = part_at(beams, run, valley->position);
      is_pair = two_fit_better(parts, run, fit, valley->sigmas > kClearProminence);
    }
    if (!is_pair && !small && span_m < kWidestPair_m) {
      if (const auto gap = find_gap(beams, run)) {
        parts = part_at(beams, run, *gap);
        is_pair = two_fit_better(parts, run, fit, true);
      }
    }
    if (!is_pair && !small && span_m < kWidestPair_m) {
      if (const auto step = find_step(beams, run, range_sd_m)) {
        parts = part_at(beams, run, *step);
        is_pair = two_fit_better(parts, run, fit, true);
      }
    }
    if (!is_pair) continue;
    order_by_depth(parts.before, parts.after, fit);
    replace({parts.before, parts.after});
    --k;  // three may touch
  }
}

}  // namespace orchard::laser
