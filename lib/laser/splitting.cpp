// SPDX-License-Identifier: BSD-3-Clause
#include "laser/splitting.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

#include "geometry/angles.hpp"
#include "laser/candidates.hpp"
#include "laser/circle_fit.hpp"
#include "laser/tuning.hpp"

namespace orchard::laser {
namespace {

/// The part without its number of beams.
Candidate bounded(const Candidate& candidate, std::ptrdiff_t first, std::ptrdiff_t last) {
  Candidate part = candidate;
  part.first = first;
  part.last = last;
  if (first > candidate.first) part.touches_before = true, part.hidden_before = false;
  if (last < candidate.last) part.touches_after = true, part.hidden_after = false;
  return part;
}

}  // namespace

Candidate part_of(const Beams& beams, const Candidate& candidate, std::ptrdiff_t first,
                  std::ptrdiff_t last) {
  Candidate part = bounded(candidate, first, last);
  part.num_beams = 0;
  for_each_beam(beams, part, [&](std::ptrdiff_t) { ++part.num_beams; });
  return part;
}

Split split_at(const Beams& beams, const Candidate& candidate, std::ptrdiff_t position) {
  std::ptrdiff_t next = candidate.last;
  for_each_beam(beams, candidate, [&](std::ptrdiff_t i) {
    if (i > position) next = std::min(next, i);
  });
  return {part_of(beams, candidate, candidate.first, position),
          part_of(beams, candidate, next, candidate.last)};
}

void order_by_depth(Candidate& before, Candidate& after, CandidateFitter& fit) {
  const auto first = fit(before), second = fit(after);
  if (!first || !second) return;
  // The circles are in different frames (each relative to its first beam): only distances compare.
  const double behind_m = std::hypot(second->x_m, second->y_m) - std::hypot(first->x_m, first->y_m);
  if (std::abs(behind_m) < tuning::kBehind * std::min(first->radius_m, second->radius_m)) return;
  const bool first_is_nearer = behind_m > 0.0;
  (first_is_nearer ? before.touches_after : after.touches_before) = false;
  (first_is_nearer ? after.hidden_before : before.hidden_after) = true;
}

namespace {

using geometry::kPi;

/// derived: standard deviations that a chi2 falls below its mean in 1 of 1000 cases.
constexpr double kRareSigmas = 3.0;

double square(double x) { return x * x; }

}  // namespace

PartEvidence::PartEvidence(const WidthConfig& width, const SegmentationConfig& config,
                           double beam_spacing_m, double span_m, double range_sd_m, int num_beams)
    : width_(width),
      width_sd_m_(std::max(width.sd_m, WidthConfig::kSdFloor_m)),
      width_max_m_(config.width_max_m),
      beam_spacing_m_(beam_spacing_m),
      span_m_(span_m + beam_spacing_m),
      num_beams_(num_beams) {
  // Two touching things stand in any direction from one another, a flat one is turned by any angle:
  // the depth between the middles of the two halves is d = span / 2 x sine of an angle that is
  // uniform over half a turn, of density 2 / (pi span) at 0. Each half's depth is a mean over n / 2
  // beams.
  const double depth_sd_m = 2.0 * range_sd_m / std::sqrt(static_cast<double>(num_beams));
  const double posterior = std::sqrt(2.0 * kPi) * depth_sd_m;
  of_depth_ = std::max(0.0, -2.0 * std::log(posterior * 2.0 / (kPi * span_m_)));
}

double PartEvidence::of_width(double width_m, double width_sd_m) const {
  const double variance_m2 = square(width_sd_m_) + square(width_sd_m);
  const double of_trunks = std::exp(-0.5 * square(width_m - width_.mean_m) / variance_m2) /
                           std::sqrt(2.0 * kPi * variance_m2);
  const double density = 0.5 * of_trunks + 0.5 / width_max_m_;
  // The side between two parts lies between two beams; that of one thing is as well known.
  return -2.0 * std::log(density * beam_spacing_m_);
}

double PartEvidence::of_circle(const CircleFit& circle, const Candidate& part) const {
  const int num_assumed = (part.touches_before ? 1 : 0) + (part.touches_after ? 1 : 0);
  const int num_measured = circle.dof + 3 - num_assumed;
  return circle.chi2 - num_measured +
         of_width(2.0 * circle.radius_m, 2.0 * std::sqrt(circle.covariance[5]));
}

double PartEvidence::of_hidden_trunk(const CircleFit& circle) const {
  // The trunk's width is integrated out: what the beams leave of the prior's spread. One
  // measurement of the fit is the prior.
  const double left = 2.0 * std::sqrt(circle.covariance[5]) / width_sd_m_;
  return circle.chi2 - (circle.dof + 2) - 2.0 * std::log(0.5 * std::min(1.0, left));
}

double PartEvidence::of_line(double chi2) const {
  // Half of the things are trunks, which are round, and of the others half are flat.
  return chi2 - num_beams_ - 2 - 2.0 * std::log(0.25 / width_max_m_ * beam_spacing_m_) + of_depth_;
}

double PartEvidence::of_second_circle() const { return of_depth_ - 2.0 * std::log(tuning::kPairs); }

double PartEvidence::least_of_two() const {
  const double alike = 2.0 * of_width(0.5 * span_m_, 0.0);
  const double unlike = of_width(width_.mean_m, 0.0) + of_width(span_m_ - width_.mean_m, 0.0);
  return std::min(alike, unlike) + of_second_circle() - kRareSigmas * std::sqrt(2.0 * num_beams_);
}

namespace {

/// derived: longest part of clutter, as many beams as have a cost.
constexpr std::size_t kMaxThinBeams = tuning::kThinCosts.size();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Range of a circle's near side in a direction of its frame; 0 if it lies beside that.
double range_of_circle_m(const CircleFit& circle, const Direction& direction) {
  const double along_m = circle.x_m * direction.c + circle.y_m * direction.s;
  const double across_m = circle.y_m * direction.c - circle.x_m * direction.s;
  const double half_chord2_m2 = circle.radius_m * circle.radius_m - across_m * across_m;
  return half_chord2_m2 > 0.0 ? along_m - std::sqrt(half_chord2_m2) : 0.0;
}

}  // namespace

Candidate BestSplit::part(const Candidate& candidate, std::size_t from, std::size_t to) const {
  Candidate part = bounded(candidate, positions_[from], positions_[to - 1]);
  part.num_beams = static_cast<int>(to - from);
  return part;
}

void BestSplit::extend_explanation(std::size_t from, std::size_t to, double cost, Kind kind) {
  const bool is_circle = kind != Kind::kClutter;
  const std::size_t more = is_circle ? 1 : 0;
  for (std::size_t circles = 0; circles + more <= kMaxCircles; ++circles) {
    const Explanation& before = explanations_[circles][from];
    // Two adjacent clutter parts would be one longer part.
    if (!is_circle && from > 0 && before.kind == Kind::kClutter) continue;
    Explanation& explanation = explanations_[circles + more][to];
    if (before.cost + cost < explanation.cost) explanation = {before.cost + cost, from, kind};
  }
}

void BestSplit::extend_by_hidden_trunk(const Candidate& piece, std::size_t from, std::size_t to,
                                       const std::optional<CircleFit>& near,
                                       const PartEvidence& evidence) {
  const auto extend = [&](bool Candidate::*hidden, Kind kind, std::size_t end, std::size_t beside) {
    const double beside_m = beams_.range_m(positions_[beside]);
    if (beams_.range_m(positions_[end]) < beside_m) return;
    Candidate behind = piece;
    behind.*hidden = true;
    const auto circle = fit_.good(behind, near, evidence.radius_prior());
    // It goes on behind the neighbour's outermost beam; less than a beam is not known to be hidden.
    const std::ptrdiff_t offset = positions_[beside] - piece.first;
    const double bearing_rad = static_cast<double>(offset) * beams_.step_rad();
    const Direction direction{std::cos(bearing_rad), std::sin(bearing_rad)};
    if (circle && range_of_circle_m(*circle, direction) > beside_m) {
      extend_explanation(from, to, evidence.of_hidden_trunk(*circle), kind);
    }
  };
  if (from > 0) extend(&Candidate::hidden_before, Kind::kBehindBefore, from, from - 1);
  if (to < positions_.size()) extend(&Candidate::hidden_after, Kind::kBehindAfter, to - 1, to);
}

bool BestSplit::extend_by_first_circle(const Candidate& candidate, std::size_t from,
                                       std::size_t least, const PartEvidence& evidence) {
  int num_misfits = tuning::kMaxMisfitsAtFirst;
  std::optional<CircleFit> last;  // warm start from the circle fitted to one beam less
  for (std::size_t to = least; to <= positions_.size(); ++to) {
    if (extend_by_circle(part(candidate, from, to), from, to, last, evidence)) {
      num_misfits = tuning::kMaxMisfits;
    } else if (--num_misfits == 0) {
      break;
    }
  }
  return last.has_value();
}

void BestSplit::extend_by_last_circle(const Candidate& candidate, std::size_t from,
                                      std::size_t least, const PartEvidence& evidence) {
  const std::size_t n = positions_.size();
  std::optional<CircleFit> last;
  for (std::size_t to = n; to >= std::max(least, n - kMaxThinBeams); --to) {
    if (extend_by_circle(part(candidate, from, to), from, to, last, evidence)) return;
  }
}

bool BestSplit::extend_by_circle(const Candidate& piece, std::size_t from, std::size_t to,
                                 std::optional<CircleFit>& last, const PartEvidence& evidence) {
  const auto circle = fit_.good(piece, last);
  if (circle) {
    last = circle;
    extend_explanation(from, to, evidence.of_circle(*circle, piece), Kind::kCircle);
  }
  extend_by_hidden_trunk(piece, from, to, last, evidence);
  return circle.has_value();
}

void BestSplit::find_explanations(const Candidate& candidate, const PartEvidence& evidence) {
  const std::size_t n = positions_.size();
  const std::size_t fewest = std::max<std::size_t>(
      kMinPartBeams,
      static_cast<std::size_t>(std::ceil(tuning::kMinFraction * static_cast<double>(n))));
  for (auto& explanations : explanations_)
    explanations.assign(n + 1, {kInfinity, 0, Kind::kClutter});
  explanations_[0][0].cost = 0.0;
  bool begins = false;
  for (std::size_t from = 0; from < n; ++from) {
    for (std::size_t thin = 1; thin <= std::min(kMaxThinBeams, n - from); ++thin) {
      extend_explanation(from, from + thin, tuning::kThinCosts[thin - 1], Kind::kClutter);
    }
    // Beams at an end are clutter only where no good circle takes them in.
    if (from <= kMaxThinBeams) {
      if (!begins) begins = extend_by_first_circle(candidate, from, from + fewest, evidence);
    } else if (explanations_[1][from].cost < kInfinity) {
      extend_by_last_circle(candidate, from, from + fewest, evidence);
    }
  }
}

void BestSplit::drop_mixed() {
  const auto is_nearer = [&](const Candidate& thin, const Candidate& beside,
                             std::ptrdiff_t border) {
    const float farthest_m = std::max(beams_.range_m(thin.first), beams_.range_m(thin.last));
    return beside.num_beams < kMinPartBeams || farthest_m < beams_.range_m(border);
  };
  std::vector<Candidate> kept;
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    const Candidate& part = parts_[k];
    const bool in_foreground =
        (k == 0 || is_nearer(part, parts_[k - 1], parts_[k - 1].last)) &&
        (k + 1 == parts_.size() || is_nearer(part, parts_[k + 1], parts_[k + 1].first));
    if (part.num_beams >= kMinPartBeams || in_foreground) kept.push_back(part);
  }
  parts_ = std::move(kept);
}

const std::vector<Candidate>& BestSplit::operator()(const Candidate& candidate,
                                                    const PartEvidence& evidence) {
  positions_.clear();
  for_each_beam(beams_, candidate, [&](std::ptrdiff_t i) { positions_.push_back(i); });
  const std::size_t n = positions_.size();
  find_explanations(candidate, evidence);
  for (Explanation& two : explanations_[2]) two.cost += evidence.of_second_circle();
  std::size_t circles = 1;
  for (std::size_t c = 2; c <= kMaxCircles; ++c) {
    if (explanations_[c][n].cost < explanations_[circles][n].cost) circles = c;
  }
  parts_.clear();
  const double min_cost = explanations_[circles][n].cost;
  if (min_cost == kInfinity) return parts_;
  const auto one = fit_(candidate);
  if (one && evidence.of_circle(*one, candidate) <= min_cost) return parts_;
  const double line_chi2 = laser::line_chi2(fit_.arc(candidate), fit_.range_sd_m(candidate));
  if (evidence.of_line(line_chi2) <= min_cost) return parts_;

  std::size_t num_thin_beams = 0;
  for (std::size_t to = n; to > 0;) {
    const Explanation& explanation = explanations_[circles][to];
    parts_.push_back(part(candidate, explanation.from, to));
    if (explanation.kind == Kind::kBehindBefore) parts_.back().hidden_before = true;
    if (explanation.kind == Kind::kBehindAfter) parts_.back().hidden_after = true;
    const bool is_circle = explanation.kind != Kind::kClutter;
    if (!is_circle) num_thin_beams += to - explanation.from;
    circles -= is_circle ? 1 : 0;
    to = explanation.from;
  }
  if (static_cast<double>(num_thin_beams) > tuning::kMaxClutterFraction * static_cast<double>(n)) {
    parts_.clear();
    return parts_;
  }
  std::reverse(parts_.begin(), parts_.end());
  for (std::size_t k = 0; k + 1 < parts_.size(); ++k) {
    if (std::min(parts_[k].num_beams, parts_[k + 1].num_beams) < kMinPartBeams) continue;
    Candidate &before = parts_[k], &after = parts_[k + 1];
    if (before.hidden_after == after.hidden_before) {
      order_by_depth(before, after, fit_);
    } else {
      (before.hidden_after ? after.touches_before : before.touches_after) = false;
    }
  }
  drop_mixed();
  return parts_;
}

namespace {

/// derived: gain in chi2 of three more parameters that noise alone reaches in 1 of 2000 candidates.
constexpr double kClearlyBetter = 18.0;
/// derived: range step in sigmas that noise causes in 1 of 10^5 pairs of neighbours.
constexpr double kStepSigmas = 4.5;
/// derived: largest width and number of beams of a tree with two stems, for which BestSplit is
/// used: its cost grows with the square of the beams.
constexpr double kMaxTwinsWidth_m = 0.4;
constexpr int kMaxBeamsTried = 40;
/// physical: largest width of two trunks, one behind the other.
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
    double highest_m = tuning::kProminence * range_sd_m;
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
  return (hidden && chi2 < tuning::kGoodFit * (candidate.num_beams - 2)) ||
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
      is_pair = two_fit_better(parts, candidate, fit, valley->sigmas > tuning::kClearProminence);
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
