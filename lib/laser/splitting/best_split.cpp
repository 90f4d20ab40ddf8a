// SPDX-License-Identifier: BSD-3-Clause
#include "laser/splitting/best_split.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "laser/splitting/candidate_parts.hpp"
#include "laser/splitting/line_fit.hpp"

namespace orchard::laser {
namespace {

constexpr std::size_t kMaxThinBeams = 2;
/// Penalty of a part of one or two clutter beams, in chi2.
constexpr std::array<double, kMaxThinBeams> kThinCosts{15.0, 18.0};
/// Largest fraction of the beams that may be clutter.
constexpr double kMaxClutterFraction = 0.25;
/// Smallest fraction of the beams in a circle: fewer are mixed pixels at a trunk's border.
constexpr double kMinFraction = 1.0 / 6.0;
/// Number of consecutive part lengths without a good circle after which longer ones are not tried.
/// The first lengths may all lie on a trunk's border, so more of them are allowed.
constexpr int kMaxMisfits = 3;
constexpr int kMaxMisfitsAtFirst = 8;
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
  return part_of(beams_, candidate, positions_[from], positions_[to - 1]);
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
  int num_misfits = kMaxMisfitsAtFirst;
  std::optional<CircleFit> last;  // warm start from the circle fitted to one beam less
  for (std::size_t to = least; to <= positions_.size(); ++to) {
    if (extend_by_circle(part(candidate, from, to), from, to, last, evidence)) {
      num_misfits = kMaxMisfits;
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
      kMinPartBeams, static_cast<std::size_t>(std::ceil(kMinFraction * static_cast<double>(n))));
  for (auto& explanations : explanations_)
    explanations.assign(n + 1, {kInfinity, 0, Kind::kClutter});
  explanations_[0][0].cost = 0.0;
  bool begins = false;
  for (std::size_t from = 0; from < n; ++from) {
    for (std::size_t thin = 1; thin <= std::min(kMaxThinBeams, n - from); ++thin) {
      extend_explanation(from, from + thin, kThinCosts[thin - 1], Kind::kClutter);
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
  if (static_cast<double>(num_thin_beams) > kMaxClutterFraction * static_cast<double>(n)) {
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

}  // namespace orchard::laser
