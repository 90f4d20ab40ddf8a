// SPDX-License-Identifier: BSD-3-Clause
#include "laser/splitting/split_touching.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "laser/splitting/best_split.hpp"
#include "laser/splitting/candidate_fit.hpp"
#include "laser/splitting/candidate_parts.hpp"
#include "laser/splitting/line_fit.hpp"

namespace orchard::laser {
namespace {

/// Min gain in chi2 of two circles over one. Noise alone reaches it in 1 of 2000 candidates (three
/// more parameters).
constexpr double kClearlyBetter = 18.0;
/// Min prominence of a range maximum between two bulges, in sigmas, for a split to be tried.
constexpr double kProminence = 2.0;
/// Prominence in sigmas above which a split is accepted even if no single circle fits to compare.
constexpr double kClearProminence = 8.0;
/// Range step in sigmas that noise causes in 1 of 10^5 pairs of neighbours.
constexpr double kStepSigmas = 4.5;
/// Largest width and number of beams of a tree with two stems, for which BestSplit is used.
constexpr double kMaxTwinsWidth_m = 0.4;
constexpr int kMaxBeamsTried = 40;
/// Largest width of two trunks, one behind the other.
constexpr double kMaxPairWidth_m = 1.0;

/// The most prominent range maximum between two nearer beams, if it exceeds the noise.
struct Valley {
  std::ptrdiff_t position = 0;
  double sigmas = 0.0;
};

class ValleyFinder {
 public:
  std::optional<Valley> operator()(const Beams& beams, const Candidate& candidate,
                                   double range_sd_m) {
    positions_.clear();
    for_each_beam(beams, candidate, [&](std::ptrdiff_t i) { positions_.push_back(i); });
    const std::size_t n = positions_.size();
    if (n < 2 * kMinPartBeams) return std::nullopt;
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

/// The beam before the largest range step, if noise and curvature do not explain the step.
std::optional<std::ptrdiff_t> find_step(const Beams& beams, const Candidate& candidate,
                                        double range_sd_m) {
  const double spacing_m = beams.range_m(candidate.first) * beams.step_rad();
  const double radius_m = 0.25 * static_cast<double>(candidate.last - candidate.first) * spacing_m;
  // Largest recession of a round surface per beam, as in trim_border(), for half the candidate.
  const double limb_m = std::min(radius_m, std::sqrt(2.0 * radius_m * spacing_m));
  double highest_m = limb_m + kStepSigmas * std::sqrt(2.0) * range_sd_m;
  std::optional<std::ptrdiff_t> best;
  std::ptrdiff_t before = candidate.first;
  for_each_beam(beams, candidate, [&](std::ptrdiff_t i) {
    const double height_m = std::abs(beams.range_m(i) - beams.range_m(before));
    if (height_m > highest_m) {
      highest_m = height_m;
      best = before;
    }
    before = i;
  });
  return best;
}

/// The beam before the first one without return: a mixed pixel between two surfaces often has none.
std::optional<std::ptrdiff_t> find_gap(const Beams& beams, const Candidate& candidate) {
  std::optional<std::ptrdiff_t> before;
  for (std::ptrdiff_t i = candidate.first + kMinPartBeams; i < candidate.last && !before; ++i) {
    if (beams.range_m(i) <= 0.0f) before = i - 1;
  }
  return before;
}

/// Whether both parts have a good circle and together fit clearly better than one circle.
/// `without_one`: the result if no single circle fits at all.
bool two_fit_better(const Split& parts, const Candidate& candidate, CandidateFitter& fit,
                    bool without_one) {
  if (std::min(parts.before.num_beams, parts.after.num_beams) < kMinPartBeams) return false;
  const auto first = fit.good(parts.before);
  if (!first) return false;
  const auto second = fit.good(parts.after);
  if (!second) return false;
  const auto one = fit(candidate);
  return one ? one->chi2 - first->chi2 - second->chi2 > kClearlyBetter : without_one;
}

/// Whether a candidate is flat: a line is more probable than any share of its span between two
/// stems, or a side is hidden, where any large circle fits and a split would not be determined.
bool is_flat(const Candidate& candidate, const PartEvidence& evidence, CandidateFitter& fit) {
  const Arc& arc = fit.arc(candidate);
  const bool hidden = arc.low_side_sd_rad == 0.0 || arc.high_side_sd_rad == 0.0;
  const double chi2 = line_chi2(arc, fit.range_sd_m(candidate));
  return (hidden && chi2 < kGoodFit * (candidate.num_beams - 2)) ||
         evidence.of_line(chi2) < evidence.least_of_two();
}

bool has_bright(const Beams& beams, const Candidate& candidate) {
  bool is_bright = false;
  if (beams.has_bright()) {
    for_each_beam(beams, candidate, [&](std::ptrdiff_t i) { is_bright |= beams.bright(i); });
  }
  return is_bright;
}

}  // namespace

void split_touching(const Beams& beams, const SegmentationConfig& config, const WidthConfig& width,
                    const LaserConfig& laser, CandidateFitter& fit,
                    std::vector<Candidate>& candidates) {
  if (!config.split_touching) return;
  ValleyFinder find_valley;
  BestSplit best_split(beams, fit);
  for (std::size_t k = 0; k < candidates.size();) {
    const Candidate candidate = candidates[k];
    const double range_m = beams.range_m(candidate.first);
    const double span_m =
        static_cast<double>(candidate.last - candidate.first) * beams.step_rad() * range_m;
    const double range_sd_m = laser.range_sd_at(range_m);
    ++k;
    if (span_m > 2.0 * config.width_max_m || candidate.num_beams <= kMinPartBeams) continue;
    const auto replace = [&](const std::vector<Candidate>& parts) {
      candidates[k - 1] = parts.front();
      candidates.insert(candidates.begin() + static_cast<std::ptrdiff_t>(k), parts.begin() + 1,
                        parts.end());
    };
    const bool small = span_m <= kMaxTwinsWidth_m && candidate.num_beams <= kMaxBeamsTried;
    // Where a reflector shows what stands there, bright_cut tells the parts.
    if (small && has_bright(beams, candidate)) continue;
    if (small) {
      // Most trunks end here: no share of the span between two stems is as probable as the circle.
      const PartEvidence evidence(width, config, beams.step_rad() * range_m, span_m, range_sd_m,
                                  candidate.num_beams);
      const auto one = fit(candidate);
      if (fits(one) && evidence.of_circle(*one, candidate) < evidence.least_of_two()) continue;
      if (is_flat(candidate, evidence, fit)) continue;
      const std::vector<Candidate>& parts = best_split(candidate, evidence);
      if (parts.empty()) continue;
      replace(parts);
      k += parts.size() - 1;
      continue;
    }
    Split parts;
    bool is_pair = false;
    if (const auto valley = find_valley(beams, candidate, range_sd_m)) {
      parts = split_at(beams, candidate, valley->position);
      is_pair = two_fit_better(parts, candidate, fit, valley->sigmas > kClearProminence);
    }
    if (!is_pair && span_m < kMaxPairWidth_m) {
      if (const auto gap = find_gap(beams, candidate)) {
        parts = split_at(beams, candidate, *gap);
        is_pair = two_fit_better(parts, candidate, fit, true);
      }
    }
    if (!is_pair && span_m < kMaxPairWidth_m) {
      if (const auto step = find_step(beams, candidate, range_sd_m)) {
        parts = split_at(beams, candidate, *step);
        is_pair = two_fit_better(parts, candidate, fit, true);
      }
    }
    if (!is_pair) continue;
    order_by_depth(parts.before, parts.after, fit);
    replace({parts.before, parts.after});
    --k;  // a part may be split again: three trunks may touch
  }
}

}  // namespace orchard::laser
