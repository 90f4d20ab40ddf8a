// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/row_chains.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <numeric>
#include <utility>

#include "geometry/angles.hpp"
#include "geometry/point_grid.hpp"
#include "geometry/statistics.hpp"
#include "mapping/tuning.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

/// Tree spacing along the rows [m] in the presence of clutter. Stems, bushes and hedges only reduce
/// nearest-neighbour distances, so the upper quartile is used.
double spacing_amid_clutter_m(const geometry::IndexedPoints& points) {
  std::vector<double> distances_m;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (double reach_m = 2.0; reach_m < 200.0; reach_m *= 3.0) {
      const auto near = points.nearest_few(points[i], reach_m, 2);
      if (near.size() < 2) continue;
      const auto other = index_of(near[0]) == i ? near[1] : near[0];
      distances_m.push_back((points[index_of(other)] - points[i]).norm());
      break;
    }
  }
  return geometry::quantile(std::move(distances_m), 0.75);
}

}  // namespace

std::vector<double> row_strengths(const std::vector<const Landmark*>& trees) {
  std::vector<double> strengths;
  for (const Landmark* tree : trees) strengths.push_back(tree->probability * tree->roc_mean);
  const double half = 0.5 * geometry::median(strengths);
  for (double& s : strengths) s = half > 0.0 ? s / half : 1.0;
  return strengths;
}

std::vector<std::size_t> seed_trees(const std::vector<Vector2d>& p_map,
                                    const std::vector<double>& strengths) {
  std::vector<Vector2d> strong;
  for (std::size_t i = 0; i < p_map.size(); ++i) {
    if (strengths[i] >= 1.0) strong.push_back(p_map[i]);
  }
  const double reach_m = tuning::kOnePlace_spacings *
                         spacing_amid_clutter_m(geometry::IndexedPoints(std::move(strong)));
  const geometry::IndexedPoints all(p_map);
  std::vector<std::size_t> by_strength(p_map.size());
  std::iota(by_strength.begin(), by_strength.end(), std::size_t{0});
  std::stable_sort(by_strength.begin(), by_strength.end(),
                   [&](std::size_t a, std::size_t b) { return strengths[a] > strengths[b]; });
  std::vector<char> stands(p_map.size(), 0);
  std::vector<std::size_t> seeds;
  for (const std::size_t i : by_strength) {
    if (strengths[i] < 1.0) break;
    const std::vector<std::int32_t> near = all.within(p_map[i], reach_m);
    if (std::any_of(near.begin(), near.end(),
                    [&](std::int32_t k) { return stands[index_of(k)]; })) {
      continue;
    }
    stands[i] = 1;
    seeds.push_back(i);
  }
  std::sort(seeds.begin(), seeds.end());
  return seeds;
}

namespace {

constexpr int kNumAngles = 60;                                 ///< derived: over half a turn
constexpr double kAngleStep_rad = geometry::kPi / kNumAngles;  ///< derived: from it
/// derived: Lateral tolerance of a line, in spacings: the displacement of the line at its reach by
/// half an angle step.
constexpr double kBeside_spacings = 0.1;
/// derived: beliefs spread over as many neighbourhoods, which is a row of 50 trees.
constexpr int kTracingRounds = 12;

using Votes = std::array<float, kNumAngles>;
using VoteArray = Eigen::Array<float, kNumAngles, 1>;

struct Neighbours {
  std::vector<std::int32_t> indices;
};

double nearest_distance_m(const geometry::IndexedPoints& points, std::size_t i) {
  for (double reach_m = 2.0; reach_m < 600.0; reach_m *= 2.0) {
    double nearest_m = reach_m;
    points.near(points[i], reach_m, [&](std::int32_t j) {
      if (static_cast<std::size_t>(j) == i) return;
      nearest_m = std::min(nearest_m, (points[static_cast<std::size_t>(j)] - points[i]).norm());
    });
    if (nearest_m < reach_m) return nearest_m;
  }
  return 600.0;
}

/// For each angle, the number of neighbours on the line through tree i (soft count).
Votes votes_of(const std::vector<Eigen::Vector2d>& p_map, const std::vector<std::int32_t>& near,
               std::size_t i, double spacing_m) {
  static const std::array<Eigen::Vector2d, kNumAngles> axes = [] {
    std::array<Eigen::Vector2d, kNumAngles> unit;
    for (std::size_t k = 0; k < unit.size(); ++k) {
      const double angle_rad = static_cast<double>(k) * kAngleStep_rad;
      unit[k] = {std::cos(angle_rad), std::sin(angle_rad)};
    }
    return unit;
  }();
  Votes votes{};
  const double beside_m = kBeside_spacings * spacing_m;
  for (const std::int32_t j : near) {
    const Eigen::Vector2d d = p_map[static_cast<std::size_t>(j)] - p_map[i];
    for (std::size_t k = 0; k < axes.size(); ++k) {
      const double beside = (axes[k].x() * d.y() - axes[k].y() * d.x()) / beside_m;
      if (std::abs(beside) < 3.0) votes[k] += static_cast<float>(std::exp(-0.5 * beside * beside));
    }
  }
  return votes;
}

void normalise(Votes& votes) {
  float sum = 0.0f;
  for (const float v : votes) sum += v;
  if (sum <= 0.0f) {
    votes.fill(1.0f / kNumAngles);
    return;
  }
  for (float& v : votes) v /= sum;
}

Votes blurred(const Votes& votes) {
  // derived: binomial weights, nearly
  constexpr std::array<float, 5> kKernel{0.06f, 0.24f, 0.4f, 0.24f, 0.06f};
  std::array<float, kNumAngles + 4> around;  // half a turn, with two more on each side
  std::copy(votes.end() - 2, votes.end(), around.begin());
  std::copy(votes.begin(), votes.end(), around.begin() + 2);
  std::copy(votes.begin(), votes.begin() + 2, around.end() - 2);
  Votes out{};
  for (std::size_t s = 0; s < kKernel.size(); ++s) {
    for (std::size_t k = 0; k < out.size(); ++k) out[k] += kKernel[s] * around[k + s];
  }
  return out;
}

/// Angle of the maximum [rad], by parabolic interpolation.
double peak_rad(const Votes& votes) {
  const auto peak = static_cast<int>(std::max_element(votes.begin(), votes.end()) - votes.begin());
  const auto at = [&](int k) {
    return static_cast<double>(votes[static_cast<std::size_t>((k + kNumAngles) % kNumAngles)]);
  };
  const double bend = at(peak - 1) - 2.0 * at(peak) + at(peak + 1);
  const double shift = bend < 0.0 ? 0.5 * (at(peak - 1) - at(peak + 1)) / bend : 0.0;
  return (peak + shift) * kAngleStep_rad;
}

/// Makes neighbours agree on one of several families of lines (relaxation labelling): repeatedly
/// multiplies each tree's own votes by the mean belief of its neighbourhood.
void agree(std::vector<Votes>& belief, const std::vector<Neighbours>& neighbours) {
  const std::vector<Votes> own = belief;
  for (int round = 0; round < kTracingRounds; ++round) {
    // A tree's new belief waits until the last of its neighbours has used the old one: of trees
    // sorted by position few wait at a time.
    std::deque<Votes> waiting;
    std::size_t first = 0;  ///< of those that wait
    const auto take_until = [&](std::size_t end, std::size_t used) {
      for (; first < end; ++first, waiting.pop_front()) {
        const std::vector<std::int32_t>& of_first = neighbours[first].indices;
        if (!of_first.empty() && static_cast<std::size_t>(of_first.back()) >= used) return;
        belief[first] = waiting.front();
      }
    };
    for (std::size_t i = 0; i < belief.size(); ++i) {
      take_until(i, i);
      Votes around = belief[i];
      for (const std::int32_t j : neighbours[i].indices) {
        // The same sums as of a loop, four at a time: most of the work of finding rows.
        Eigen::Map<VoteArray>(around.data()) +=
            Eigen::Map<const VoteArray>(belief[static_cast<std::size_t>(j)].data());
      }
      normalise(around);
      around = blurred(around);
      Votes& next = waiting.emplace_back();
      for (std::size_t k = 0; k < kNumAngles; ++k) {
        next[k] = (own[i][k] + 1e-4f) * (around[k] + 1e-6f);
      }
      normalise(next);
    }
    take_until(belief.size(), belief.size());
  }
}

/// Direction through tree i, refined by the mean offset of its neighbours in the row.
Eigen::Vector2d refined(const std::vector<Eigen::Vector2d>& p_map,
                        const std::vector<std::int32_t>& near, std::size_t i, double spacing_m,
                        const Eigen::Vector2d& axis) {
  Eigen::Vector2d sum(0.0, 0.0);
  for (const std::int32_t j : near) {
    const Eigen::Vector2d d = p_map[static_cast<std::size_t>(j)] - p_map[i];
    const double along = d.dot(axis);
    const double beside = axis.x() * d.y() - axis.y() * d.x();
    if (std::abs(along) > 2.6 * spacing_m || std::abs(beside) > 0.3 * std::abs(along)) continue;
    sum += along < 0.0 ? Eigen::Vector2d(-d) : d;
  }
  return sum.norm() > 0.3 * spacing_m ? sum.normalized() : axis;
}

/// Flips the axes so that all agree with the mean axis.
void orient(std::vector<Eigen::Vector2d>& axes) {
  Eigen::Vector2d doubled(0.0, 0.0);
  for (const Eigen::Vector2d& a : axes) {
    doubled += Eigen::Vector2d(a.x() * a.x() - a.y() * a.y(), 2.0 * a.x() * a.y());
  }
  const double mean_rad = 0.5 * std::atan2(doubled.y(), doubled.x());
  const Eigen::Vector2d mean(std::cos(mean_rad), std::sin(mean_rad));
  for (Eigen::Vector2d& a : axes) {
    if (a.dot(mean) < 0.0) a = -a;
  }
}

}  // namespace

RowDirections row_directions(const std::vector<Eigen::Vector2d>& p_map) {
  RowDirections result;
  if (p_map.size() < 3) return result;
  const geometry::IndexedPoints points(p_map);
  std::vector<double> nearest_m;
  for (std::size_t i = 0; i < p_map.size(); ++i) {
    nearest_m.push_back(nearest_distance_m(points, i));
  }
  result.spacing_m = std::max(0.05, geometry::median(std::move(nearest_m)));

  const double reach_m = tuning::kReach_spacings * result.spacing_m;
  std::vector<Neighbours> neighbours(p_map.size());
  std::vector<Votes> belief(p_map.size());
  for (std::size_t i = 0; i < p_map.size(); ++i) {
    std::vector<std::int32_t> near = points.within(p_map[i], reach_m);
    near.erase(std::remove(near.begin(), near.end(), static_cast<std::int32_t>(i)), near.end());
    neighbours[i].indices.assign(near.begin(), near.end());  // without room to grow
    belief[i] = votes_of(p_map, near, i, result.spacing_m);
    normalise(belief[i]);
  }
  agree(belief, neighbours);
  for (std::size_t i = 0; i < p_map.size(); ++i) {
    const double angle_rad = peak_rad(belief[i]);
    result.directions.push_back(refined(p_map, neighbours[i].indices, i, result.spacing_m,
                                        {std::cos(angle_rad), std::sin(angle_rad)}));
  }
  orient(result.directions);
  return result;
}

double distance_to_segment_m(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const Vector2d d = b - a;
  const double square = d.squaredNorm();
  const double fraction = square > 0.0 ? std::clamp((p - a).dot(d) / square, 0.0, 1.0) : 0.0;
  return (p - (a + fraction * d)).norm();
}

namespace {

constexpr std::int32_t kNone = -1;  // derived: no index

struct Step {
  double along_m = 0.0;   ///< positive ahead
  double beside_m = 0.0;  ///< positive to the left
};

class Linker {
 public:
  Linker(const std::vector<Eigen::Vector2d>& p_map, const RowDirections& rows)
      : p_map_(p_map),
        spacing_m_(rows.spacing_m),
        directions_(rows.directions),
        points_(p_map),
        next_(p_map.size(), kNone),
        previous_(p_map.size(), kNone) {
    row_spacing_m_ = row_spacing_m();
  }

  void link(double gap_max_spacings) {
    for (double reach = 1.6; reach < gap_max_spacings; reach += 1.0) {
      link_within(reach);
      take_directions_from_links();
    }
    link_within(gap_max_spacings);
  }

  std::vector<RowChain> chains() const {
    std::vector<RowChain> all;
    for (std::size_t i = 0; i < p_map_.size(); ++i) {
      if (previous_[i] != kNone) continue;
      RowChain chain;
      for (auto k = static_cast<std::int32_t>(i); k != kNone; k = next_[index(k)]) {
        chain.push_back(k);
      }
      all.push_back(std::move(chain));
    }
    return all;
  }

 private:
  static std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }

  /// Vector from i to j in the mean direction of both trees' rows (the chord of an arc).
  Step step(std::int32_t i, std::int32_t j) const {
    const Eigen::Vector2d u = (directions_[index(i)] + directions_[index(j)]).normalized();
    const Eigen::Vector2d d = p_map_[index(j)] - p_map_[index(i)];
    return {u.dot(d), u.x() * d.y() - u.y() * d.x()};
  }

  /// Whether the directions of both trees' rows and the vector between them agree.
  bool in_line(std::int32_t i, std::int32_t j) const {
    const Eigen::Vector2d &u = directions_[index(i)], &v = directions_[index(j)];
    const Eigen::Vector2d way = (p_map_[index(j)] - p_map_[index(i)]).normalized();
    return u.dot(v) > tuning::kTurnMax_cos && std::abs(way.dot(u)) > tuning::kTurnMax_cos &&
           std::abs(way.dot(v)) > tuning::kTurnMax_cos;
  }

  /// Median distance to the nearest tree beside, in another row.
  double row_spacing_m() const {
    std::vector<double> beside_m;
    const double reach_m = 4.0 * spacing_m_, along_max_m = 0.6 * spacing_m_;
    for (std::size_t i = 0; i < p_map_.size(); ++i) {
      double nearest_m = reach_m;
      points_.near(p_map_[i], std::hypot(reach_m, along_max_m), [&](std::int32_t j) {
        const Step s = step(static_cast<std::int32_t>(i), j);
        if (std::abs(s.along_m) > along_max_m) return;
        if (std::abs(s.beside_m) < 0.4 * spacing_m_) return;
        nearest_m = std::min(nearest_m, std::abs(s.beside_m));
      });
      beside_m.push_back(nearest_m);
    }
    return geometry::median(std::move(beside_m));
  }

  /// The unlinked tree that follows i (or precedes it) within reach at minimum cost; kNone if there
  /// is none.
  std::int32_t best(std::int32_t i, bool ahead, double reach_m) const {
    double least = std::numeric_limits<double>::infinity();
    std::int32_t found = kNone;
    // Far enough for every candidate, so that the index's cells decide nothing.
    const double radius_m = std::hypot(reach_m, tuning::kBesideMax_row_spacings * row_spacing_m_);
    points_.near(p_map_[index(i)], radius_m, [&](std::int32_t j) {
      if (j == i || (ahead ? previous_ : next_)[index(j)] != kNone) return;
      if (!in_line(i, j)) return;
      const Step s = step(i, j);
      const double along_m = ahead ? s.along_m : -s.along_m;
      if (along_m < tuning::kOnePlace_spacings * spacing_m_ || along_m > reach_m) return;
      const double beside_m = std::abs(s.beside_m);
      if (beside_m > std::min(tuning::kBesideMax_row_spacings * row_spacing_m_,
                              0.15 * spacing_m_ + 0.15 * along_m)) {
        return;
      }
      const double cost = along_m + tuning::kCostBeside * beside_m;
      if (cost < least || (cost == least && j < found)) {
        least = cost;
        found = j;
      }
    });
    return found;
  }

  /// Links trees that choose each other, until nothing changes.
  void link_within(double reach_spacings) {
    const double reach_m = reach_spacings * spacing_m_;
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t i = 0; i < p_map_.size(); ++i) {
        const auto from = static_cast<std::int32_t>(i);
        if (next_[i] != kNone) continue;
        const std::int32_t to = best(from, true, reach_m);
        if (to == kNone || best(to, false, reach_m) != from || closes_ring(from, to)) continue;
        next_[i] = to;
        previous_[index(to)] = from;
        changed = true;
      }
    }
  }

  /// Updates the directions from the links, which are more precise than the votes: of a linked tree
  /// along its links, of an unlinked tree from the linked ones around it.
  void take_directions_from_links() {
    std::vector<Eigen::Vector2d> linked(p_map_.size(), Eigen::Vector2d(0.0, 0.0));
    for (std::size_t i = 0; i < p_map_.size(); ++i) {
      const std::int32_t before = previous_[i], after = next_[i];
      if (before != kNone) linked[i] += p_map_[i] - p_map_[index(before)];
      if (after != kNone) linked[i] += p_map_[index(after)] - p_map_[i];
      if (before != kNone || after != kNone) linked[i].normalize();
    }
    for (std::size_t i = 0; i < p_map_.size(); ++i) {
      if (!linked[i].isZero()) {
        directions_[i] = linked[i];
        continue;
      }
      Eigen::Vector2d sum(0.0, 0.0);
      for (const std::int32_t j : points_.within(p_map_[i], 4.0 * spacing_m_)) {
        sum += linked[index(j)];
      }
      if (sum.norm() > 0.5) directions_[i] = sum.normalized();
    }
  }

  bool closes_ring(std::int32_t from, std::int32_t to) const {
    for (std::int32_t k = to; k != kNone; k = next_[index(k)]) {
      if (k == from) return true;
    }
    return false;
  }

  const std::vector<Eigen::Vector2d>& p_map_;
  double spacing_m_ = 0.0;
  std::vector<Eigen::Vector2d> directions_;
  geometry::IndexedPoints points_;
  std::vector<std::int32_t> next_, previous_;
  double row_spacing_m_ = 0.0;
};

}  // namespace

std::vector<RowChain> row_chains(const std::vector<Eigen::Vector2d>& p_map,
                                 const RowDirections& rows, double gap_max_spacings) {
  if (rows.directions.size() != p_map.size()) return {};
  Linker linker(p_map, rows);
  linker.link(gap_max_spacings);
  return linker.chains();
}

}  // namespace orchard::mapping
