// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/navigation_graph.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "geometry/statistics.hpp"
#include "mapping/compare/landmark_pairing.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

constexpr double kStep_m = 1.0;        ///< between points of a centre line
constexpr double kWidestAlley = 2.5;   ///< of the usual distance of rows
constexpr double kSideReach_m = 15.0;  ///< farther away no row stands beside another

using Line = std::vector<Vector2d>;

Vector2d right_of(const Vector2d& u) { return {u.y(), -u.x()}; }

Line line_of(const Row& row) {
  Line line;
  for (const RowPlace& place : row.places) line.push_back(place.p_map);
  return line;
}

double length_m(const Line& line) {
  double sum_m = 0.0;
  for (std::size_t i = 1; i < line.size(); ++i) sum_m += (line[i] - line[i - 1]).norm();
  return sum_m;
}

struct LinePoint {
  Vector2d p{0, 0};
  Vector2d along{1, 0};
};

/// Points along a line at even steps, its ends among them.
std::vector<LinePoint> walked(const Line& line) {
  std::vector<LinePoint> points;
  const double whole_m = length_m(line);
  if (line.size() < 2 || whole_m <= 0.0) return points;
  const int num = std::max(1, static_cast<int>(std::ceil(whole_m / kStep_m)));
  std::size_t segment = 1;
  double before_m = 0.0;
  for (int k = 0; k <= num; ++k) {
    const double s_m = whole_m * k / num;
    while (segment + 1 < line.size() &&
           before_m + (line[segment] - line[segment - 1]).norm() < s_m) {
      before_m += (line[segment] - line[segment - 1]).norm();
      ++segment;
    }
    const Vector2d d = line[segment] - line[segment - 1];
    const double share = d.norm() > 0.0 ? std::clamp((s_m - before_m) / d.norm(), 0.0, 1.0) : 0.0;
    // the direction of a few steps, so that single trees out of line do not turn it
    const std::size_t first = segment >= 2 ? segment - 2 : 0;
    const std::size_t last = std::min(segment + 1, line.size() - 1);
    points.push_back({line[segment - 1] + share * d, (line[last] - line[first]).normalized()});
  }
  return points;
}

/// How far to the right of a point a line crosses its normal.
std::optional<double> right_distance_m(const LinePoint& at, const Line& line) {
  std::optional<double> nearest_m;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const double a = at.along.dot(line[i - 1] - at.p), b = at.along.dot(line[i] - at.p);
    if ((a > 0.0) == (b > 0.0) && a != 0.0 && b != 0.0) continue;
    const double share = a == b ? 0.0 : a / (a - b);
    const double d_m = right_of(at.along).dot(line[i - 1] + share * (line[i] - line[i - 1]) - at.p);
    if (d_m > 0.0 && (!nearest_m || d_m < *nearest_m)) nearest_m = d_m;
  }
  return nearest_m;
}

/// The row that most points along row r have as the nearest to their right; -1 for none.
int right_neighbour(const std::vector<std::vector<LinePoint>>& walks,
                    const std::vector<Line>& lines, std::size_t r) {
  constexpr std::size_t kSamples = 9;
  std::map<int, int> votes;
  for (std::size_t k = 0; k < kSamples; ++k) {
    if (walks[r].empty()) return -1;
    const LinePoint& at = walks[r][k * (walks[r].size() - 1) / (kSamples - 1)];
    int nearest = -1;
    double nearest_m = kSideReach_m;
    for (std::size_t q = 0; q < lines.size(); ++q) {
      if (q == r) continue;
      const auto d_m = right_distance_m(at, lines[q]);
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

/// Things in the map, and how near a way may come to them.
struct Obstacles {
  IndexedPoints places;
  std::vector<double> radius_m;
};

Obstacles obstacles_of(const std::vector<Landmark>& landmarks) {
  std::vector<Vector2d> places;
  std::vector<double> radius_m;
  for (const Landmark& l : landmarks) {
    places.push_back({l.x_m, l.y_m});
    radius_m.push_back(0.5 * l.width_m);
  }
  return {IndexedPoints(std::move(places)), std::move(radius_m)};
}

/// Free width across a way at one of its points, within `half_m` to each side at most.
double free_width_m(const LinePoint& at, double half_m, const Obstacles& obstacles) {
  double left_m = half_m, right_m = half_m;
  for (const std::int32_t i : obstacles.places.within(at.p, half_m + kStep_m)) {
    const auto k = static_cast<std::size_t>(i);
    const Vector2d d = obstacles.places[k] - at.p;
    if (std::abs(at.along.dot(d)) > 0.5 * kStep_m + obstacles.radius_m[k]) continue;
    const double side_m = right_of(at.along).dot(d);
    double& free_m = side_m > 0.0 ? right_m : left_m;
    free_m = std::min(free_m, std::max(0.0, std::abs(side_m) - obstacles.radius_m[k]));
  }
  return left_m + right_m;
}

double narrowest_m(const Line& line, double half_m, const Obstacles& obstacles) {
  double width_m = 2.0 * half_m;
  for (const LinePoint& at : walked(line)) {
    width_m = std::min(width_m, free_width_m(at, half_m, obstacles));
  }
  return width_m;
}

/// The longest run of points midway between a row and its neighbour, and their distance.
struct Alley {
  std::size_t left = 0, right = 0;
  std::vector<LinePoint> middle;
  double distance_m = 0.0;
  std::int32_t from = 0, to = 0;  ///< nodes
};

Alley alley_between(const std::vector<LinePoint>& walk, const Line& right) {
  Alley best, run;
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
    const auto d_m = right_distance_m(at, right);
    if (!d_m || *d_m > kSideReach_m) {
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

std::vector<Alley> alleys_of(const std::vector<Line>& lines) {
  std::vector<std::vector<LinePoint>> walks;
  for (const Line& line : lines) walks.push_back(walked(line));
  std::vector<Alley> alleys;
  std::vector<double> distances_m;
  for (std::size_t r = 0; r < lines.size(); ++r) {
    const int q = right_neighbour(walks, lines, r);
    if (q < 0) continue;
    Alley alley = alley_between(walks[r], lines[static_cast<std::size_t>(q)]);
    if (alley.middle.size() < 2) continue;
    alley.left = r;
    alley.right = static_cast<std::size_t>(q);
    distances_m.push_back(alley.distance_m);
    alleys.push_back(std::move(alley));
  }
  const double widest_m = kWidestAlley * geometry::median(distances_m);
  alleys.erase(std::remove_if(alleys.begin(), alleys.end(),
                              [&](const Alley& alley) { return alley.distance_m > widest_m; }),
               alleys.end());
  return alleys;
}

/// Round the end of a row from one alley to the next: straight, or past the row's last place.
Line round_end(const Vector2d& from, const Vector2d& to, const Vector2d& row_end,
               const Vector2d& outwards, double beyond_m) {
  const Vector2d past = row_end + beyond_m * outwards;
  const double lead_m = outwards.dot(past - 0.5 * (from + to));
  if (lead_m <= 0.0) return {from, to};
  return {from, past, to};
}

}  // namespace

NavigationGraph navigation_graph(const std::vector<Landmark>& landmarks,
                                 const std::vector<Row>& rows) {
  NavigationGraph graph;
  std::vector<Line> lines;
  for (const Row& row : rows) lines.push_back(line_of(row));
  const Obstacles obstacles = obstacles_of(landmarks);
  std::vector<Alley> alleys = alleys_of(lines);
  const auto add_node = [&](const Vector2d& p) {
    graph.nodes.push_back({static_cast<std::int32_t>(graph.nodes.size()) + 1, p});
    return graph.nodes.back().id;
  };
  const auto node_at = [&](std::int32_t id) -> const Vector2d& {
    return graph.nodes[static_cast<std::size_t>(id) - 1].p_map;
  };
  const auto add_edge = [&](NavigationEdge edge, double half_m) {
    edge.id = static_cast<std::int32_t>(graph.edges.size()) + 1;
    edge.length_m = length_m(edge.line_map);
    edge.width_m = narrowest_m(edge.line_map, half_m, obstacles);
    graph.edges.push_back(std::move(edge));
  };

  for (Alley& alley : alleys) {
    const LinePoint &first = alley.middle.front(), &last = alley.middle.back();
    const double beyond_m = 0.5 * alley.distance_m;
    alley.from = add_node(first.p - beyond_m * first.along);
    alley.to = add_node(last.p + beyond_m * last.along);
    NavigationEdge edge;
    edge.kind = WayKind::kAlley;
    edge.from = alley.from;
    edge.to = alley.to;
    edge.row_left = rows[alley.left].number;
    edge.row_right = rows[alley.right].number;
    edge.line_map.push_back(node_at(alley.from));
    for (const LinePoint& at : alley.middle) edge.line_map.push_back(at.p);
    edge.line_map.push_back(node_at(alley.to));
    add_edge(std::move(edge), 0.5 * alley.distance_m);
  }
  for (const Alley& alley : alleys) {
    for (const Alley& next : alleys) {
      if (next.left != alley.right) continue;
      const Line& row = lines[alley.right];
      const double beyond_m = 0.25 * (alley.distance_m + next.distance_m);
      for (const bool at_end : {false, true}) {
        NavigationEdge edge;
        edge.kind = WayKind::kHeadland;
        edge.from = at_end ? alley.to : alley.from;
        edge.to = at_end ? next.to : next.from;
        edge.row_left = rows[alley.right].number;
        const Vector2d outwards =
            at_end ? Vector2d(row.back() - row[row.size() - 2]) : Vector2d(row.front() - row[1]);
        edge.line_map =
            round_end(node_at(edge.from), node_at(edge.to), at_end ? row.back() : row.front(),
                      outwards.normalized(), beyond_m);
        add_edge(std::move(edge), 2.0 * beyond_m);
      }
    }
  }
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
