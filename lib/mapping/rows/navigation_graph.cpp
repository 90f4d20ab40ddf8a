// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/navigation_graph.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "geometry/statistics.hpp"
#include "mapping/extent/extent.hpp"
#include "mapping/rows/row_chains.hpp"

namespace orchard::mapping {

double length_m(const Line& line) {
  double sum_m = 0.0;
  for (std::size_t i = 1; i < line.size(); ++i) sum_m += (line[i] - line[i - 1]).norm();
  return sum_m;
}

std::vector<LinePoint> sample_line(const Line& line, double step_m) {
  std::vector<LinePoint> points;
  const double whole_m = length_m(line);
  if (line.size() < 2 || whole_m <= 0.0) return points;
  const int num = std::max(1, static_cast<int>(std::ceil(whole_m / step_m)));
  std::size_t segment = 1;
  double before_m = 0.0;
  for (int k = 0; k <= num; ++k) {
    const double s_m = whole_m * k / num;
    while (segment + 1 < line.size() &&
           before_m + (line[segment] - line[segment - 1]).norm() < s_m) {
      before_m += (line[segment] - line[segment - 1]).norm();
      ++segment;
    }
    const Eigen::Vector2d d = line[segment] - line[segment - 1];
    const double fraction =
        d.norm() > 0.0 ? std::clamp((s_m - before_m) / d.norm(), 0.0, 1.0) : 0.0;
    // Direction over several segments, so that single points out of line do not turn it.
    const std::size_t first = segment >= 2 ? segment - 2 : 0;
    const std::size_t last = std::min(segment + 1, line.size() - 1);
    points.push_back({line[segment - 1] + fraction * d, (line[last] - line[first]).normalized()});
  }
  return points;
}

namespace {

using Eigen::Vector2d;

constexpr double kBeside_m = 0.1;  ///< derived: of candidate lines, under a third of a corridor
constexpr int kTurnMax = 2;        ///< derived: offsets from one station to the next: 22 degrees
constexpr double kInfinity = std::numeric_limits<double>::infinity();  // derived: no obstacle

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
      nearest_m = std::min(nearest_m,
                           distance_to_segment_m(places_[k], line[s - 1], line[s]) - radius_m_[k]);
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

namespace {

constexpr double kWayStep_m = 0.5;  ///< derived: of an edge's points: shorter than any vehicle
/// derived: times the median distance: one row may be missing.
constexpr double kWidestAisle = 2.5;
constexpr double kSideReach_m = 15.0;  ///< derived: twice the aisle of a wide planting

Line line_of(const Row& row) {
  Line line;
  for (const RowSlot& place : row.places) line.push_back(place.p_map);
  return line;
}

/// A line with boxes around runs of its segments, so that a search passes over what is far away.
struct BoxedLine {
  /// derived: boxes of 8 m between trees.
  static constexpr std::size_t kRun_segments = 16;

  explicit BoxedLine(const Line& points) : line(points) {
    for (std::size_t i = 1; i < line.size(); ++i) {
      if ((i - 1) % kRun_segments == 0) runs.emplace_back(line[i - 1]);
      runs.back().extend(line[i]);
    }
    for (const Eigen::AlignedBox2d& run : runs) box.extend(run);
  }

  const Line& line;
  std::vector<Eigen::AlignedBox2d> runs;
  Eigen::AlignedBox2d box;
};

/// Distance to the right from a point to the nearest crossing of a line with the normal, if that is
/// at most `reach_m`.
std::optional<double> right_distance_m(const LinePoint& at, const BoxedLine& boxed,
                                       double reach_m) {
  // derived: above the rounding of coordinates of kilometres.
  constexpr double kRounding_m = 1e-6;
  const Line& line = boxed.line;
  const auto is_far = [&](const Eigen::AlignedBox2d& box) {
    return box.exteriorDistance(at.p) > reach_m + kRounding_m;
  };
  std::optional<double> nearest_m;
  if (is_far(boxed.box)) return nearest_m;
  for (std::size_t run = 0; run < boxed.runs.size(); ++run) {
    if (is_far(boxed.runs[run])) continue;
    const std::size_t begin = 1 + run * BoxedLine::kRun_segments;
    const std::size_t end = std::min(begin + BoxedLine::kRun_segments, line.size());
    for (std::size_t i = begin; i < end; ++i) {
      const double a = at.along.dot(line[i - 1] - at.p), b = at.along.dot(line[i] - at.p);
      if ((a > 0.0) == (b > 0.0) && a != 0.0 && b != 0.0) continue;
      const double fraction = a == b ? 0.0 : a / (a - b);
      const double d_m =
          right_of(at.along).dot(line[i - 1] + fraction * (line[i] - line[i - 1]) - at.p);
      if (d_m > 0.0 && d_m <= reach_m && (!nearest_m || d_m < *nearest_m)) nearest_m = d_m;
    }
  }
  return nearest_m;
}

/// The row that is the nearest to the right of row r at most of its sample points; -1 for none.
int right_neighbour(const std::vector<std::vector<LinePoint>>& walks,
                    const std::vector<BoxedLine>& lines, std::size_t r) {
  // derived: an odd number of votes.
  constexpr std::size_t kSamples = 9;
  std::map<int, int> votes;
  for (std::size_t k = 0; k < kSamples; ++k) {
    if (walks[r].empty()) return -1;
    const LinePoint& at = walks[r][k * (walks[r].size() - 1) / (kSamples - 1)];
    int nearest = -1;
    double nearest_m = kSideReach_m;
    for (std::size_t q = 0; q < lines.size(); ++q) {
      if (q == r) continue;
      const auto d_m = right_distance_m(at, lines[q], nearest_m);
      if (d_m && *d_m < nearest_m) {
        nearest_m = *d_m;
        nearest = static_cast<int>(q);
      }
    }
    if (nearest >= 0) ++votes[nearest];
  }
  int best = -1, most = 0;
  for (const auto& [row, count] : votes) {
    if (count > most) best = row, most = count;
  }
  return best;
}

/// The longest contiguous midline between a row and its right neighbour, and their median distance.
struct Aisle {
  std::size_t left = 0, right = 0;
  std::vector<LinePoint> middle;
  double distance_m = 0.0;
  std::int32_t from = 0, to = 0;  ///< node ids
};

Aisle aisle_between(const std::vector<LinePoint>& walk, const BoxedLine& right) {
  Aisle best, run;
  std::vector<double> distances_m, best_distances_m;
  const auto take = [&] {
    if (run.middle.size() > best.middle.size()) {
      best = run;
      best_distances_m = distances_m;
    }
    run.middle.clear();
    distances_m.clear();
  };
  for (const LinePoint& at : walk) {
    const auto d_m = right_distance_m(at, right, kSideReach_m);
    if (!d_m) {
      take();
      continue;
    }
    run.middle.push_back({at.p + 0.5 * *d_m * right_of(at.along), at.along});
    distances_m.push_back(*d_m);
  }
  take();
  best.distance_m = geometry::median(std::move(best_distances_m));
  return best;
}

std::vector<Aisle> aisles_of(const std::vector<Line>& lines) {
  std::vector<std::vector<LinePoint>> walks;
  for (const Line& line : lines) walks.push_back(sample_line(line, kWayStep_m));
  const std::vector<BoxedLine> boxed(lines.begin(), lines.end());
  std::vector<Aisle> aisles;
  std::vector<double> distances_m;
  for (std::size_t r = 0; r < lines.size(); ++r) {
    const int q = right_neighbour(walks, boxed, r);
    if (q < 0) continue;
    Aisle aisle = aisle_between(walks[r], boxed[static_cast<std::size_t>(q)]);
    if (aisle.middle.size() < 2) continue;
    aisle.left = r;
    aisle.right = static_cast<std::size_t>(q);
    distances_m.push_back(aisle.distance_m);
    aisles.push_back(std::move(aisle));
  }
  const double aisle_width_max_m = kWidestAisle * geometry::median(distances_m);
  aisles.erase(
      std::remove_if(aisles.begin(), aisles.end(),
                     [&](const Aisle& aisle) { return aisle.distance_m > aisle_width_max_m; }),
      aisles.end());
  return aisles;
}

/// Path around the end of a row from one aisle to the next: straight if that passes the row's end,
/// else via a point beyond the row's last tree.
Line round_end(const Vector2d& from, const Vector2d& to, const Vector2d& row_end,
               const Vector2d& outwards, double beyond_m) {
  const Vector2d past = row_end + beyond_m * outwards;
  const double lead_m = outwards.dot(past - 0.5 * (from + to));
  if (lead_m <= 0.0) return {from, to};
  return {from, past, to};
}

/// Midline of the aisle, extended at both ends by up to half its width.
Guide guide_of(const Aisle& aisle) {
  Guide guide;
  guide.half_m = 0.5 * aisle.distance_m;
  guide.num_extra = static_cast<std::size_t>(std::lround(guide.half_m / kWayStep_m));
  const auto extend = [&](const LinePoint& end, double outwards, std::size_t k) {
    const double beyond_m =
        outwards * guide.half_m * static_cast<double>(k) / static_cast<double>(guide.num_extra);
    guide.stations.push_back({end.p + beyond_m * end.along, end.along});
  };
  for (std::size_t k = guide.num_extra; k > 0; --k) extend(aisle.middle.front(), -1.0, k);
  guide.stations.insert(guide.stations.end(), aisle.middle.begin(), aisle.middle.end());
  for (std::size_t k = 1; k <= guide.num_extra; ++k) extend(aisle.middle.back(), 1.0, k);
  return guide;
}

class GraphBuilder {
 public:
  GraphBuilder(const std::vector<Landmark>& landmarks, const std::vector<Row>& rows,
               const FreeSpaceTest& seen_free)
      : rows_(rows), obstacles_(landmarks), seen_free_(seen_free) {
    for (const Row& row : rows) lines_.push_back(line_of(row));
  }

  NavigationGraph build() {
    std::vector<Aisle> aisles = aisles_of(lines_);
    aisles.erase(std::remove_if(aisles.begin(), aisles.end(),
                                [this](Aisle& aisle) { return !add_aisle(aisle); }),
                 aisles.end());
    for (const Aisle& aisle : aisles) {
      for (const Aisle& next : aisles) {
        if (next.left != aisle.right) continue;
        add_headland(aisle, next, false);
        add_headland(aisle, next, true);
      }
    }
    return std::move(graph_);
  }

 private:
  std::int32_t add_node(const Vector2d& p) {
    graph_.nodes.push_back({static_cast<std::int32_t>(graph_.nodes.size()) + 1, p});
    return graph_.nodes.back().id;
  }
  const Vector2d& node_at(std::int32_t id) const {
    return graph_.nodes[static_cast<std::size_t>(id) - 1].p_map;
  }

  void add_edge(NavigationEdge edge, Corridor corridor) {
    edge.id = static_cast<std::int32_t>(graph_.edges.size()) + 1;
    edge.length_m = length_m(corridor.line);
    edge.width_m = corridor.width_m;
    edge.line_map = std::move(corridor.line);
    graph_.edges.push_back(std::move(edge));
  }

  /// Returns false if there is no free corridor.
  bool add_aisle(Aisle& aisle) {
    auto corridor = free_corridor(guide_of(aisle), obstacles_, seen_free_);
    if (!corridor) return false;
    aisle.from = add_node(corridor->line.front());
    aisle.to = add_node(corridor->line.back());
    NavigationEdge edge;
    edge.kind = EdgeKind::kAisle;
    edge.from = aisle.from;
    edge.to = aisle.to;
    edge.row_left = rows_[aisle.left].number;
    edge.row_right = rows_[aisle.right].number;
    add_edge(std::move(edge), *std::move(corridor));
    return true;
  }

  void add_headland(const Aisle& aisle, const Aisle& next, bool at_end) {
    const Line& row = lines_[aisle.right];
    const double beyond_m = 0.25 * (aisle.distance_m + next.distance_m);
    NavigationEdge edge;
    edge.kind = EdgeKind::kHeadland;
    edge.from = at_end ? aisle.to : aisle.from;
    edge.to = at_end ? next.to : next.from;
    edge.row_left = rows_[aisle.right].number;
    const Vector2d outwards =
        at_end ? Vector2d(row.back() - row[row.size() - 2]) : Vector2d(row.front() - row[1]);
    Guide guide;
    guide.stations =
        sample_line(round_end(node_at(edge.from), node_at(edge.to),
                              at_end ? row.back() : row.front(), outwards.normalized(), beyond_m),
                    kWayStep_m);
    guide.half_m = beyond_m;
    guide.pinned = true;
    if (auto corridor = free_corridor(guide, obstacles_, seen_free_)) {
      add_edge(std::move(edge), *std::move(corridor));
    }
  }

  const std::vector<Row>& rows_;
  std::vector<Line> lines_;
  Obstacles obstacles_;
  const FreeSpaceTest& seen_free_;
  NavigationGraph graph_;
};

}  // namespace

NavigationGraph navigation_graph(const std::vector<Landmark>& landmarks,
                                 const std::vector<Row>& rows, const FreeSpaceTest& seen_free) {
  return GraphBuilder(landmarks, rows, seen_free).build();
}

NavigationGraph narrowed(NavigationGraph graph, const std::vector<Landmark>& landmarks) {
  if (landmarks.empty()) return graph;
  const Obstacles obstacles(landmarks);
  std::set<std::int32_t> nodes;
  const auto is_shut = [&](NavigationEdge& edge) {
    const double half_m = 0.5 * edge.width_m;
    const double clearance_m = obstacles.clearance_m(edge.line_map, half_m);
    if (clearance_m < half_m) edge.width_m = 2.0 * clearance_m;
    if (clearance_m < half_m && clearance_m < kHalfCorridorMin_m) return true;
    nodes.insert({edge.from, edge.to});
    return false;
  };
  std::vector<NavigationEdge>& edges = graph.edges;
  edges.erase(std::remove_if(edges.begin(), edges.end(), is_shut), edges.end());
  graph.nodes.erase(std::remove_if(graph.nodes.begin(), graph.nodes.end(),
                                   [&](const auto& node) { return nodes.count(node.id) == 0; }),
                    graph.nodes.end());
  return graph;
}

RowSpacing row_spacing(const Row& row) {
  RowSpacing spacing;
  std::vector<double> steps_m;
  for (std::size_t i = 1; i < row.places.size(); ++i) {
    if (row.places[i].landmark_id == 0 || row.places[i - 1].landmark_id == 0) continue;
    steps_m.push_back((row.places[i].p_map - row.places[i - 1].p_map).norm());
  }
  if (steps_m.empty()) return spacing;
  double mean_m = 0.0;
  for (const double step_m : steps_m) mean_m += step_m / static_cast<double>(steps_m.size());
  for (const double step_m : steps_m) spacing.sd_m += (step_m - mean_m) * (step_m - mean_m);
  spacing.sd_m =
      steps_m.size() < 2 ? 0.0 : std::sqrt(spacing.sd_m / static_cast<double>(steps_m.size() - 1));
  spacing.least_m = *std::min_element(steps_m.begin(), steps_m.end());
  spacing.most_m = *std::max_element(steps_m.begin(), steps_m.end());
  spacing.median_m = geometry::median(std::move(steps_m));
  return spacing;
}

}  // namespace orchard::mapping
