// SPDX-License-Identifier: BSD-3-Clause
#include "laser/splitting/best_parts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "laser/splitting/line_fit.hpp"
#include "laser/splitting/run_parts.hpp"

namespace orchard::laser {
namespace {

constexpr std::size_t kMostThinBeams = 2;
/// What a circle or a line costs, in chi2: noise alone gains as much in 1 of some thousand.
constexpr double kPartCost = 18.0;
constexpr std::array<double, kMostThinBeams> kThinCosts{15.0, 18.0};
/// At most this share of the beams may be left to something thin.
constexpr double kMostThinShare = 0.25;
/// A part shows at least this share of the beams: less is a trunk's rim, half on something else.
constexpr double kLeastShare = 1.0 / 6.0;
/// Where so many stretches one after the other are no circle, longer ones are none either; the
/// first ones may all lie on a trunk's rim.
constexpr int kMostMisfits = 3;
constexpr int kMostMisfitsAtFirst = 8;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

Run BestParts::part(const Run& run, std::size_t from, std::size_t to) const {
  return part_of(beams_, run, positions_[from], positions_[to - 1]);
}

void BestParts::go_on(std::size_t from, std::size_t to, double cost, bool is_circle) {
  const std::size_t more = is_circle ? 1 : 0;
  for (std::size_t circles = 0; circles + more <= kMostCircles; ++circles) {
    const Way& before = ways_[circles][from];
    // something thin beside something thin would be less so
    if (!is_circle && from > 0 && !before.is_circle) continue;
    Way& way = ways_[circles + more][to];
    if (before.cost + cost < way.cost) way = {before.cost + cost, from, is_circle};
  }
}

void BestParts::find_ways(const Run& run) {
  const std::size_t n = positions_.size();
  const std::size_t fewest = std::max<std::size_t>(
      kFewestBeamsOfAPart,
      static_cast<std::size_t>(std::ceil(kLeastShare * static_cast<double>(n))));
  for (auto& ways : ways_) ways.assign(n + 1, {kInfinity, 0, false});
  ways_[0][0].cost = 0.0;
  for (std::size_t from = 0; from < n; ++from) {
    for (std::size_t thin = 1; thin <= std::min(kMostThinBeams, n - from); ++thin) {
      go_on(from, from + thin, kThinCosts[thin - 1], false);
    }
    const bool is_first = from <= kMostThinBeams;  // else it is the last
    if (!is_first && ways_[1][from].cost == kInfinity) continue;
    const std::size_t least = from + fewest;
    int num_misfits = kMostMisfitsAtFirst;
    // what a beam more or less fits lies close by
    std::optional<CircleFit> last;
    for (std::size_t to = is_first ? least : std::max(least, n - kMostThinBeams); to <= n; ++to) {
      const auto circle = fit_.good(part(run, from, to), last);
      if (circle) {
        last = circle;
        go_on(from, to, kPartCost + circle->chi2 - circle->dof, true);
        num_misfits = kMostMisfits;
      } else if (--num_misfits == 0) {
        break;
      }
    }
  }
}

void BestParts::drop_mixed() {
  const auto is_nearer = [&](const Run& thin, const Run& beside, std::ptrdiff_t border) {
    const float farthest_m = std::max(beams_.range_m(thin.first), beams_.range_m(thin.last));
    return beside.num_beams < kFewestBeamsOfAPart || farthest_m < beams_.range_m(border);
  };
  std::vector<Run> kept;
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    const Run& part = parts_[k];
    const bool in_front =
        (k == 0 || is_nearer(part, parts_[k - 1], parts_[k - 1].last)) &&
        (k + 1 == parts_.size() || is_nearer(part, parts_[k + 1], parts_[k + 1].first));
    if (part.num_beams >= kFewestBeamsOfAPart || in_front) kept.push_back(part);
  }
  parts_ = std::move(kept);
}

const std::vector<Run>& BestParts::operator()(const Run& run) {
  positions_.clear();
  for_each_beam(beams_, run, [&](std::ptrdiff_t i) { positions_.push_back(i); });
  const std::size_t n = positions_.size();
  find_ways(run);
  std::size_t circles = 1;
  for (std::size_t c = 2; c <= kMostCircles; ++c) {
    if (ways_[c][n].cost < ways_[circles][n].cost) circles = c;
  }
  parts_.clear();
  const double least_cost = ways_[circles][n].cost;
  if (least_cost == kInfinity) return parts_;
  const auto one = fit_(run);
  if (one && kPartCost + one->chi2 - one->dof <= least_cost) return parts_;
  const double line_chi2 = laser::line_chi2(fit_.arc(run), fit_.range_sd_m(run));
  const double line_cost = kPartCost + line_chi2 - static_cast<double>(n) + 2.0;
  if (line_cost <= least_cost) return parts_;

  std::size_t num_thin_beams = 0;
  for (std::size_t to = n; to > 0;) {
    const Way& way = ways_[circles][to];
    parts_.push_back(part(run, way.from, to));
    if (!way.is_circle) num_thin_beams += to - way.from;
    circles -= way.is_circle ? 1 : 0;
    to = way.from;
  }
  if (static_cast<double>(num_thin_beams) > kMostThinShare * static_cast<double>(n)) {
    parts_.clear();
    return parts_;
  }
  std::reverse(parts_.begin(), parts_.end());
  for (std::size_t k = 0; k + 1 < parts_.size(); ++k) {
    if (std::min(parts_[k].num_beams, parts_[k + 1].num_beams) < kFewestBeamsOfAPart) continue;
    order_by_depth(parts_[k], parts_[k + 1], fit_);
  }
  drop_mixed();
  return parts_;
}

}  // namespace orchard::laser
