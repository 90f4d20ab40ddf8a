// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/row_selection.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "geometry/statistics.hpp"
#include "mapping/tuning.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

/// derived: Max number of rows in a map that are none, expected from objects at any position.
constexpr double kFalseRowsMax = 0.01;
/// derived: Min probability of a row against a hedge: one in ten may be wrong.
constexpr double kSure = 0.9;
constexpr int kPriorRounds = 10;

const Vector2d& at(const std::vector<Vector2d>& p_map, std::int32_t i) {
  return p_map[static_cast<std::size_t>(i)];
}

/// Median distance of a chain's trees from the line of another chain, over the trees beside it;
/// none for fewer than two.
std::optional<double> beside_m(const std::vector<Vector2d>& p_map, const RowChain& chain,
                               const RowChain& other) {
  // derived: boxes of 30 m, and above the rounding of coordinates of kilometres.
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
  /// derived: Boxes are in a turned frame, so that distances differ by rounding.
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

/// Removes tracks that are too close to a more probable one for the row distance of this orchard.
void drop_crowded_tracks(const std::vector<Vector2d>& p_map, std::vector<RowTrack>& tracks) {
  if (tracks.empty()) return;
  std::vector<RowChain> chains;
  std::vector<double> log_odds;
  for (const RowTrack& track : tracks) {
    chains.push_back(track.chain);
    log_odds.push_back(track.log_odds);
  }
  const ChainNeighbours neighbours(p_map, chains);
  const double nearest_m = tuning::kNearest_pitches * pitch_m(p_map, chains, neighbours, log_odds);
  std::vector<std::size_t> by_odds(chains.size());
  std::iota(by_odds.begin(), by_odds.end(), std::size_t{0});
  std::stable_sort(by_odds.begin(), by_odds.end(),
                   [&](std::size_t a, std::size_t b) { return log_odds[a] > log_odds[b]; });
  std::vector<char> is_kept(chains.size(), 0);
  for (const std::size_t a : by_odds) {
    bool crowds = false;
    neighbours.visit_near(a, nearest_m, [&](std::size_t b, double&) {
      if (crowds || !is_kept[b]) return;
      const auto distance_m = beside_m(p_map, chains[a], chains[b]);
      crowds = distance_m && *distance_m < nearest_m;
    });
    is_kept[a] = !crowds;
  }
  std::vector<RowTrack> kept;
  for (std::size_t a = 0; a < chains.size(); ++a) {
    if (is_kept[a]) kept.push_back(std::move(tracks[a]));
  }
  tracks = std::move(kept);
}

/// Log odds that a line of objects in this map is a row and not a hedge, from all its lines
/// (expectation maximisation); one more of either kind is assumed.
double log_odds_of_rows(const std::vector<RowTrack>& tracks) {
  double prior = 0.0;
  for (int round = 0; round < kPriorRounds; ++round) {
    double num_rows = 1.0;
    for (const RowTrack& track : tracks) {
      num_rows += 1.0 / (1.0 + std::exp(-track.log_odds_in_line - prior));
    }
    prior = std::log(num_rows / (static_cast<double>(tracks.size()) + 2.0 - num_rows));
  }
  return prior;
}

}  // namespace

void keep_probable_rows(const std::vector<Vector2d>& p_map, std::vector<RowTrack>& tracks) {
  const auto drop_if = [&](const auto& is_no_row) {
    tracks.erase(std::remove_if(tracks.begin(), tracks.end(), is_no_row), tracks.end());
  };
  drop_if([](const RowTrack& track) { return track.chain.size() < kRowTreesMin; });
  drop_if([](const RowTrack& track) { return track.log_odds < -std::log(kFalseRowsMax); });
  const double prior = log_odds_of_rows(tracks);
  drop_if([&](const RowTrack& track) {
    return track.log_odds_in_line + prior < std::log(kSure / (1.0 - kSure));
  });
  drop_crowded_tracks(p_map, tracks);
}

}  // namespace orchard::mapping
