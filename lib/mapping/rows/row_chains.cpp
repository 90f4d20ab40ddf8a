// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/row_chains.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "geometry/point_grid.hpp"
#include "geometry/statistics.hpp"

namespace orchard::mapping {
namespace {

constexpr std::int32_t kNone = -1;
/// Trees closer than this along a row are in the same slot.
constexpr double kMinStep_spacings = 0.3;
/// Max lateral offset of the next tree, in distances of rows.
constexpr double kBesideMax_row_spacings = 0.35;
/// Weight of the lateral offset in the cost: the next tree should be straight ahead.
constexpr double kCostBeside = 3.0;

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
    return u.dot(v) > kTurnMax_cos && std::abs(way.dot(u)) > kTurnMax_cos &&
           std::abs(way.dot(v)) > kTurnMax_cos;
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
    const double radius_m = std::hypot(reach_m, kBesideMax_row_spacings * row_spacing_m_);
    points_.near(p_map_[index(i)], radius_m, [&](std::int32_t j) {
      if (j == i || (ahead ? previous_ : next_)[index(j)] != kNone) return;
      if (!in_line(i, j)) return;
      const Step s = step(i, j);
      const double along_m = ahead ? s.along_m : -s.along_m;
      if (along_m < kMinStep_spacings * spacing_m_ || along_m > reach_m) return;
      const double beside_m = std::abs(s.beside_m);
      if (beside_m >
          std::min(kBesideMax_row_spacings * row_spacing_m_, 0.15 * spacing_m_ + 0.15 * along_m)) {
        return;
      }
      const double cost = along_m + kCostBeside * beside_m;
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
