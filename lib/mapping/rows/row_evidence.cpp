// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/row_evidence.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "geometry/statistics.hpp"
#include "mapping/rows/row_slots.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

/// Standard deviation of a planted step, in spacings: trees lean and are seen from the side.
constexpr double kEvidenceSd_spacings = 0.12;
/// Log odds of a single step without deviation: density of a planted row with 90 % of the slots
/// filled, against one random object per spacing: ln(0.9 / (0.12 sqrt(2 pi))) + 1.
constexpr double kExactStep = 2.1;
/// Reduction of the log odds per empty slot: -(ln(0.1) + 1).
constexpr double kEmptyPlace = 1.3;
/// Limit of a step's negative log odds: a larger deviation is a false tree.
constexpr double kStepCostMax = 4.0;
/// Max relative difference of equal spacings.
constexpr double kSameSpacing = 0.15;
/// Minimum log odds of a row: two good steps of the orchard's spacing, or three of another.
constexpr double kRowMin = 3.3;
/// An end of a row is cut off if its log odds are below minus this.
constexpr double kEndMin = 4.0;
/// Minimum number of trees of the rows that determine the orchard's spacing, if there are such
/// rows.
constexpr std::size_t kTelling = 5;
/// Minimum distance of a row from a more certain one, as a fraction of the rows' distance.
constexpr double kNearest_pitches = 0.6;

const Vector2d& at(const std::vector<Vector2d>& p_map, std::int32_t i) {
  return p_map[static_cast<std::size_t>(i)];
}

std::vector<double> steps_of(const std::vector<Vector2d>& p_map, const RowChain& chain) {
  std::vector<double> steps_m;
  for (std::size_t i = 1; i < chain.size(); ++i) {
    steps_m.push_back((at(p_map, chain[i]) - at(p_map, chain[i - 1])).norm());
  }
  return steps_m;
}

double orchard_spacing_m(const std::vector<Vector2d>& p_map, const std::vector<RowChain>& chains) {
  for (const std::size_t telling : {kTelling, std::size_t{2}}) {
    std::vector<double> spacings_m;  // one per step: weights rows by length
    for (const RowChain& chain : chains) {
      if (chain.size() < telling) continue;
      const double single_m = single_step_m(steps_of(p_map, chain));
      spacings_m.insert(spacings_m.end(), chain.size() - 1, single_m);
    }
    if (!spacings_m.empty()) return geometry::median(std::move(spacings_m));
  }
  return 0.0;
}

/// Median distance of a chain's trees from the line of another chain, over the trees beside it;
/// none for fewer than two.
std::optional<double> beside_m(const std::vector<Vector2d>& p_map, const RowChain& chain,
                               const RowChain& other) {
  constexpr std::size_t kRun_segments = 16;
  constexpr double kRounding_m = 1e-6;
  std::vector<Eigen::AlignedBox2d> runs;  // boxes around them: a search passes over what is far
  for (std::size_t k = 1; k < other.size(); ++k) {
    if ((k - 1) % kRun_segments == 0) runs.emplace_back(at(p_map, other[k - 1]));
    runs.back().extend(at(p_map, other[k]));
  }
  std::vector<double> distances_m;
  std::size_t last = 0;  // the nearest run of the tree before: its distance rules out most others
  for (const std::int32_t i : chain) {
    const Vector2d& p = at(p_map, i);
    std::optional<double> nearest_m;
    std::size_t nearest_run = last;
    const auto look_at = [&](std::size_t run) {
      if (nearest_m && runs[run].exteriorDistance(p) > *nearest_m + kRounding_m) return;
      const std::size_t begin = 1 + run * kRun_segments;
      for (std::size_t k = begin; k < std::min(begin + kRun_segments, other.size()); ++k) {
        const Vector2d &a = at(p_map, other[k - 1]), d = at(p_map, other[k]) - a;
        const double fraction = d.dot(p - a) / std::max(1e-9, d.squaredNorm());
        if (fraction < 0.0 || fraction > 1.0) continue;
        const double distance_m = (a + fraction * d - p).norm();
        if (!nearest_m || distance_m < *nearest_m) nearest_m = distance_m, nearest_run = run;
      }
    };
    if (last < runs.size()) look_at(last);
    for (std::size_t run = 0; run < runs.size(); ++run) {
      if (run != last) look_at(run);
    }
    last = nearest_run;
    if (nearest_m) distances_m.push_back(*nearest_m);
  }
  if (distances_m.size() < 2) return std::nullopt;
  return geometry::median(std::move(distances_m));
}

/// The chains within a distance of one of them, without a look at all others: chains sorted across
/// the direction of the longest one.
class ChainNeighbours {
 public:
  ChainNeighbours(const std::vector<Vector2d>& p_map, const std::vector<RowChain>& chains) {
    Vector2d direction = Vector2d::UnitX();
    double longest_m = 0.0;
    for (const RowChain& chain : chains) {
      const Vector2d along = at(p_map, chain.back()) - at(p_map, chain.front());
      if (along.norm() > longest_m) longest_m = along.norm(), direction = along / longest_m;
    }
    for (const RowChain& chain : chains) {
      Eigen::AlignedBox2d box;
      for (const std::int32_t i : chain) {
        const Vector2d& p = at(p_map, i);
        box.extend(Vector2d(direction.dot(p), direction.x() * p.y() - direction.y() * p.x()));
      }
      widest_m_ = std::max(widest_m_, box.sizes().y());
      boxes_.push_back(box);
    }
    sorted_.resize(chains.size());
    std::iota(sorted_.begin(), sorted_.end(), std::size_t{0});
    std::stable_sort(sorted_.begin(), sorted_.end(), [&](std::size_t a, std::size_t b) {
      return boxes_[a].min().y() < boxes_[b].min().y();
    });
    rank_.resize(chains.size());
    for (std::size_t r = 0; r < sorted_.size(); ++r) rank_[sorted_[r]] = r;
  }

  /// Calls `visit(b, reach_m)` for each other chain b whose trees may be within `reach_m` of those
  /// of chain a; a visit may shorten the reach.
  template <typename Visit>
  void visit_near(std::size_t a, double reach_m, Visit visit) const {
    const double low = boxes_[a].min().y(), high = boxes_[a].max().y();
    const auto visit_if_near = [&](std::size_t b) {
      if (boxes_[a].exteriorDistance(boxes_[b]) <= reach_m + kRounding_m) visit(b, reach_m);
    };
    for (std::size_t r = rank_[a] + 1; r < sorted_.size(); ++r) {
      if (boxes_[sorted_[r]].min().y() > high + reach_m + kRounding_m) break;
      visit_if_near(sorted_[r]);
    }
    for (std::size_t r = rank_[a]; r-- > 0;) {
      if (boxes_[sorted_[r]].min().y() + widest_m_ < low - reach_m - kRounding_m) break;
      visit_if_near(sorted_[r]);
    }
  }

 private:
  /// Boxes are in a turned frame, so that distances differ by rounding.
  static constexpr double kRounding_m = 1e-6;

  std::vector<Eigen::AlignedBox2d> boxes_;  ///< per chain: along and across the direction (m)
  std::vector<std::size_t> sorted_,
      rank_;               ///< chains by the low side of their box, and its inverse
  double widest_m_ = 0.0;  ///< max size of a box across the direction
};

/// Typical distance of rows: median distance to the nearest neighbour, among chains with at least
/// half the maximum log odds; 0 if none are beside each other.
double pitch_m(const std::vector<Vector2d>& p_map, const std::vector<RowChain>& chains,
               const ChainNeighbours& neighbours, const std::vector<double>& log_odds) {
  const double surest = *std::max_element(log_odds.begin(), log_odds.end());
  std::vector<double> pitches_m;
  for (std::size_t a = 0; a < chains.size(); ++a) {
    if (log_odds[a] < 0.5 * surest) continue;
    double nearest_m = std::numeric_limits<double>::infinity();
    neighbours.visit_near(a, nearest_m, [&](std::size_t b, double& reach_m) {
      if (log_odds[b] < 0.5 * surest) return;
      const auto distance_m = beside_m(p_map, chains[a], chains[b]);
      if (distance_m) reach_m = nearest_m = std::min(nearest_m, *distance_m);
    });
    if (std::isfinite(nearest_m)) pitches_m.push_back(nearest_m);
  }
  return pitches_m.empty() ? 0.0 : geometry::median(std::move(pitches_m));
}

double step_log_odds(double spacings) {
  const double places = std::max(1.0, std::round(spacings));
  const double off = (spacings - places) / kEvidenceSd_spacings;
  return std::max(-kStepCostMax,
                  kExactStep - 0.5 * off * off / places - kEmptyPlace * (places - 1.0));
}

}  // namespace

RowEvidence row_evidence(const std::vector<Vector2d>& p_map, const RowChain& chain,
                         double orchard_spacing_m) {
  RowEvidence evidence;
  evidence.last = chain.empty() ? 0 : chain.size() - 1;
  if (chain.size() < 2) return evidence;
  const std::vector<double> steps_m = steps_of(p_map, chain);
  const double spacing_m = std::max(1e-3, single_step_m(steps_m));
  // Maximum-sum run of steps, and the sums before and after it.
  double run = 0.0, before_run = 0.0, sum = 0.0, best = 0.0, before = 0.0, upto = 0.0;
  std::size_t begin = 0, first = 0, last = 0;
  for (std::size_t k = 0; k < steps_m.size(); ++k) {
    const double step = step_log_odds(steps_m[k] / spacing_m);
    if (run < 0.0) run = 0.0, begin = k, before_run = sum;
    run += step;
    sum += step;
    if (run > best) best = run, first = begin, last = k + 1, before = before_run, upto = sum;
  }
  if (before < -kEndMin) evidence.first = first;
  if (sum - upto < -kEndMin) evidence.last = last;
  // A spacing of its own is estimated from one of the steps, which is then no evidence.
  const bool is_orchards = std::abs(spacing_m - orchard_spacing_m) <
                           kSameSpacing * std::max(spacing_m, orchard_spacing_m);
  evidence.log_odds = is_orchards ? best : best - kExactStep;
  return evidence;
}

void drop_irregular_chains(const std::vector<Vector2d>& p_map, std::vector<RowChain>& chains) {
  const double spacing_m = orchard_spacing_m(p_map, chains);
  std::vector<RowChain> regular;
  std::vector<double> log_odds;
  for (RowChain& chain : chains) {
    const RowEvidence evidence = row_evidence(p_map, chain, spacing_m);
    if (evidence.log_odds < kRowMin) continue;
    regular.emplace_back(chain.begin() + static_cast<std::ptrdiff_t>(evidence.first),
                         chain.begin() + static_cast<std::ptrdiff_t>(evidence.last) + 1);
    log_odds.push_back(evidence.log_odds);
  }
  chains.clear();
  if (regular.empty()) return;
  const ChainNeighbours neighbours(p_map, regular);
  const double nearest_m = kNearest_pitches * pitch_m(p_map, regular, neighbours, log_odds);
  std::vector<std::size_t> by_odds(regular.size());
  std::iota(by_odds.begin(), by_odds.end(), std::size_t{0});
  std::stable_sort(by_odds.begin(), by_odds.end(),
                   [&](std::size_t a, std::size_t b) { return log_odds[a] > log_odds[b]; });
  std::vector<char> is_kept(regular.size(), 0);
  for (const std::size_t a : by_odds) {
    bool crowds = false;
    neighbours.visit_near(a, nearest_m, [&](std::size_t b, double&) {
      if (crowds || !is_kept[b]) return;
      const auto distance_m = beside_m(p_map, regular[a], regular[b]);
      crowds = distance_m && *distance_m < nearest_m;
    });
    is_kept[a] = !crowds;
  }
  for (std::size_t a = 0; a < regular.size(); ++a) {
    if (is_kept[a]) chains.push_back(std::move(regular[a]));
  }
}

}  // namespace orchard::mapping
