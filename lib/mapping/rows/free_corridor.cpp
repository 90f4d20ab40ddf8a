// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/free_corridor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mapping/extent/long_objects.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

constexpr double kBeside_m = 0.1;  ///< distance between neighbouring candidate lines
constexpr int kTurnMax = 2;        ///< max change of the offset index between stations
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Distance from a point to a line segment.
double distance_m(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const Vector2d d = b - a;
  const double square = d.squaredNorm();
  const double fraction = square > 0.0 ? std::clamp((p - a).dot(d) / square, 0.0, 1.0) : 0.0;
  return (p - (a + fraction * d)).norm();
}

/// Clearance at each station and lateral offset of a guide.
class ClearanceTable {
 public:
  ClearanceTable(const Guide& guide, const Obstacles& obstacles, const FreeSpaceTest& seen_free)
      : guide_(guide), reach_(static_cast<int>(std::floor(guide.half_m / kBeside_m + 1e-6))) {
    for (const LinePoint& at : guide.stations) {
      std::vector<double> row(width(), 0.0);
      for (int k = -reach_; k <= reach_; ++k) {
        row[index(k)] = obstacles.clearance_m(point(at, k), guide.half_m);
      }
      if (seen_free) limit_to_seen(at, seen_free, row);
      clearance_m_.push_back(std::move(row));
    }
  }

  int reach() const { return reach_; }
  std::size_t width() const { return static_cast<std::size_t>(2 * reach_ + 1); }
  std::size_t index(int k) const { return static_cast<std::size_t>(k + reach_); }
  double at(std::size_t station, int k) const { return clearance_m_[station][index(k)]; }
  Vector2d point(std::size_t station, int k) const { return point(guide_.stations[station], k); }

 private:
  static Vector2d point(const LinePoint& at, int k) {
    return at.p + kBeside_m * k * right_of(at.along);
  }

  /// Unseen ground counts as occupied. Offsets closer than kHalfCorridorMin_m to a landmark need
  /// not be seen: no vehicle's centre passes there, and the landmark's border is the limit.
  void limit_to_seen(const LinePoint& at, const FreeSpaceTest& seen_free,
                     std::vector<double>& row) const {
    const auto matters = [&](int k) {
      return std::abs(k) <= reach_ && row[index(k)] >= kHalfCorridorMin_m;
    };
    // A tested place is two offsets wide: between two of them nothing is left to test.
    std::vector<int> unseen;
    for (int k = -reach_; k <= reach_; ++k) {
      const bool is_covered = k % 2 != 0 && matters(k - 1) && matters(k + 1);
      if (matters(k) && !is_covered && !seen_free(point(at, k))) unseen.push_back(k);
    }
    for (const int k : unseen) {
      for (int j = -reach_; j <= reach_; ++j) {
        row[index(j)] = std::min(row[index(j)], kBeside_m * std::max(0.0, std::abs(j - k) - 0.5));
      }
    }
  }

  const Guide& guide_;
  int reach_;
  std::vector<std::vector<double>> clearance_m_;
};

/// Offset indices of the best line from station `first` to station `last`; empty if there is none.
std::vector<int> best_offsets(const ClearanceTable& table, std::size_t first, std::size_t last,
                              bool pinned) {
  const int reach = table.reach();
  const auto allowed = [&](std::size_t s, int k) {
    return !pinned || k == 0 || (s != first && s != last);
  };
  // First pass of dynamic programming: maximise the minimum clearance.
  std::vector<double> widest(table.width(), -1.0);
  for (std::size_t s = first; s <= last; ++s) {
    std::vector<double> next(table.width(), -1.0);
    for (int k = -reach; k <= reach; ++k) {
      if (!allowed(s, k)) continue;
      double through = s == first ? kInfinity : -1.0;
      for (int j = std::max(-reach, k - kTurnMax); s > first && j <= std::min(reach, k + kTurnMax);
           ++j) {
        through = std::max(through, widest[table.index(j)]);
      }
      next[table.index(k)] = std::min(through, table.at(s, k));
    }
    widest = std::move(next);
  }
  const double clearance_m = *std::max_element(widest.begin(), widest.end());
  if (clearance_m < kHalfCorridorMin_m) return {};

  // Second pass: among lines of that clearance, minimise bends and the distance from the guide.
  std::vector<double> cost(table.width(), 0.0);
  std::vector<std::vector<int>> before(last - first + 1, std::vector<int>(table.width(), 0));
  for (std::size_t s = first; s <= last; ++s) {
    std::vector<double> next(table.width(), kInfinity);
    for (int k = -reach; k <= reach; ++k) {
      if (!allowed(s, k) || table.at(s, k) < clearance_m) continue;
      double least = s == first ? 0.0 : kInfinity;
      for (int j = std::max(-reach, k - kTurnMax); s > first && j <= std::min(reach, k + kTurnMax);
           ++j) {
        const double through = cost[table.index(j)] + 4.0 * (k - j) * (k - j);
        if (through >= least) continue;
        least = through;
        before[s - first][table.index(k)] = j;
      }
      next[table.index(k)] = least + 0.1 * k * k;
    }
    cost = std::move(next);
  }
  const auto end = std::min_element(cost.begin(), cost.end());
  if (*end == kInfinity) return {};
  std::vector<int> offsets(last - first + 1);
  offsets.back() = static_cast<int>(end - cost.begin()) - reach;
  for (std::size_t i = offsets.size() - 1; i > 0; --i) {
    offsets[i - 1] = before[i][table.index(offsets[i])];
  }
  return offsets;
}

/// Offset at the next station beyond an end, as close to the guide as possible; none where the
/// clearance is too small.
std::optional<int> next_offset(const ClearanceTable& table, std::size_t station, int from,
                               double clearance_m) {
  std::optional<int> best;
  for (int k = std::max(-table.reach(), from - kTurnMax);
       k <= std::min(table.reach(), from + kTurnMax); ++k) {
    if (table.at(station, k) < clearance_m) continue;
    if (!best || std::abs(k) < std::abs(*best)) best = k;
  }
  return best;
}

}  // namespace

Obstacles::Obstacles(const std::vector<Landmark>& landmarks)
    : places_([&] {
        std::vector<Vector2d> points;
        for (const Landmark& l : landmarks) {
          const std::vector<Vector2d> line = centre_line(l);
          points.insert(points.end(), line.begin(), line.end());
        }
        return points;
      }()) {
  for (const Landmark& l : landmarks) {
    radius_m_.resize(radius_m_.size() + centre_line(l).size(), 0.5 * l.width_m);
    largest_m_ = std::max(largest_m_, 0.5 * l.width_m);
  }
}

double Obstacles::clearance_m(const Vector2d& p_map, double reach_m) const {
  double nearest_m = reach_m;
  places_.near(p_map, reach_m + largest_m_, [&](std::int32_t i) {
    const auto k = static_cast<std::size_t>(i);
    nearest_m = std::min(nearest_m, (places_[k] - p_map).norm() - radius_m_[k]);
  });
  return nearest_m;
}

double Obstacles::clearance_m(const Line& line, double reach_m) const {
  double nearest_m = reach_m;
  for (std::size_t s = 1; s < line.size(); ++s) {
    const double around_m = 0.5 * (line[s] - line[s - 1]).norm() + reach_m + largest_m_;
    places_.near(0.5 * (line[s] + line[s - 1]), around_m, [&](std::int32_t i) {
      const auto k = static_cast<std::size_t>(i);
      nearest_m = std::min(nearest_m, distance_m(places_[k], line[s - 1], line[s]) - radius_m_[k]);
    });
  }
  return nearest_m;
}

std::optional<Corridor> free_corridor(const Guide& guide, const Obstacles& obstacles,
                                      const FreeSpaceTest& seen_free) {
  const std::size_t num = guide.stations.size();
  if (num < 2 * guide.num_extra + 2 || guide.half_m < kHalfCorridorMin_m) return std::nullopt;
  const ClearanceTable table(guide, obstacles, seen_free);
  std::size_t first = guide.num_extra, last = num - 1 - guide.num_extra;
  const std::vector<int> offsets = best_offsets(table, first, last, guide.pinned);
  if (offsets.empty()) return std::nullopt;
  Corridor corridor;
  double half_m = guide.half_m;
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    corridor.line.push_back(table.point(first + i, offsets[i]));
    half_m = std::min(half_m, table.at(first + i, offsets[i]));
  }
  for (int k = offsets.back(); last + 1 < num; ++last) {
    const auto next = next_offset(table, last + 1, k, half_m);
    if (!next) break;
    k = *next;
    corridor.line.push_back(table.point(last + 1, k));
  }
  Line ahead;
  for (int k = offsets.front(); first > 0; --first) {
    const auto next = next_offset(table, first - 1, k, half_m);
    if (!next) break;
    k = *next;
    ahead.push_back(table.point(first - 1, k));
  }
  corridor.line.insert(corridor.line.begin(), ahead.rbegin(), ahead.rend());
  half_m = std::min(half_m, obstacles.clearance_m(corridor.line, guide.half_m));
  if (half_m < kHalfCorridorMin_m) return std::nullopt;
  corridor.width_m = 2.0 * half_m;
  return corridor;
}

}  // namespace orchard::mapping
