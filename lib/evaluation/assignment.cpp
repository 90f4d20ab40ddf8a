// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/assignment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace orchard::evaluation {
namespace {

using Matrix = std::vector<std::vector<double>>;

/// Points that may be paired: connected by pairs within the gate.
struct Cluster {
  std::vector<std::size_t> truth;
  std::vector<std::size_t> found;
};

void require_finite(const std::vector<Point>& points) {
  for (const Point& point : points) {
    if (!std::isfinite(point.x_m) || !std::isfinite(point.y_m)) {
      throw std::invalid_argument("assign: a point is not finite");
    }
  }
}

double squared_distance_m2(const Point& a, const Point& b) {
  const double dx_m = a.x_m - b.x_m;
  const double dy_m = a.y_m - b.y_m;
  return dx_m * dx_m + dy_m * dy_m;
}

std::size_t root_of(std::vector<std::size_t>& parent, std::size_t node) {
  while (parent[node] != node) node = parent[node] = parent[parent[node]];
  return node;
}

std::vector<Cluster> clusters_within(const std::vector<Point>& truth,
                                     const std::vector<Point>& found, double gate_m) {
  // A sweep along x visits only found points within the gate's band.
  std::vector<std::size_t> by_x(found.size());
  std::iota(by_x.begin(), by_x.end(), std::size_t{0});
  std::sort(by_x.begin(), by_x.end(), [&](std::size_t a, std::size_t b) {
    return std::make_pair(found[a].x_m, a) < std::make_pair(found[b].x_m, b);
  });
  std::vector<std::size_t> parent(truth.size() + found.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  for (std::size_t t = 0; t < truth.size(); ++t) {
    auto it = std::lower_bound(by_x.begin(), by_x.end(), truth[t].x_m - gate_m,
                               [&](std::size_t f, double x_m) { return found[f].x_m < x_m; });
    for (; it != by_x.end() && found[*it].x_m <= truth[t].x_m + gate_m; ++it) {
      if (squared_distance_m2(truth[t], found[*it]) > gate_m * gate_m) continue;
      parent[root_of(parent, truth.size() + *it)] = root_of(parent, t);
    }
  }
  std::map<std::size_t, Cluster> by_root;
  for (std::size_t t = 0; t < truth.size(); ++t) by_root[root_of(parent, t)].truth.push_back(t);
  for (std::size_t f = 0; f < found.size(); ++f) {
    by_root[root_of(parent, truth.size() + f)].found.push_back(f);
  }
  std::vector<Cluster> clusters;
  for (auto& [root, cluster] : by_root) {
    if (!cluster.truth.empty() && !cluster.found.empty()) clusters.push_back(std::move(cluster));
  }
  return clusters;
}

/// Solves the assignment problem for a cost matrix with rows <= columns: the column of each row.
/// Hungarian method by shortest augmenting paths with potentials (Kuhn 1955, Munkres 1957).
std::vector<std::size_t> hungarian(const Matrix& cost) {
  const std::size_t num_rows = cost.size();
  const std::size_t num_columns = cost.front().size();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::size_t none = num_rows;
  std::vector<double> row_potential(num_rows + 1, 0.0);
  std::vector<double> column_potential(num_columns + 1, 0.0);
  // Each augmenting path starts in an extra column behind the last one.
  std::vector<std::size_t> row_of(num_columns + 1, none);
  for (std::size_t row = 0; row < num_rows; ++row) {
    std::vector<double> slack(num_columns, kInfinity);
    std::vector<std::size_t> previous(num_columns, num_columns);
    std::vector<bool> visited(num_columns + 1, false);
    std::size_t column = num_columns;
    row_of[column] = row;
    do {
      visited[column] = true;
      const std::size_t r = row_of[column];
      double step = kInfinity;
      std::size_t next = num_columns;
      for (std::size_t c = 0; c < num_columns; ++c) {
        if (visited[c]) continue;
        const double reduced = cost[r][c] - row_potential[r] - column_potential[c];
        if (reduced < slack[c]) {
          slack[c] = reduced;
          previous[c] = column;
        }
        if (slack[c] < step) {
          step = slack[c];
          next = c;
        }
      }
      for (std::size_t c = 0; c <= num_columns; ++c) {
        if (visited[c]) {
          row_potential[row_of[c]] += step;
          column_potential[c] -= step;
        } else {
          slack[c] -= step;
        }
      }
      column = next;
    } while (row_of[column] != none);
    while (column != num_columns) {
      row_of[column] = row_of[previous[column]];
      column = previous[column];
    }
  }
  std::vector<std::size_t> column_of(num_rows, num_columns);
  for (std::size_t c = 0; c < num_columns; ++c) {
    if (row_of[c] != none) column_of[row_of[c]] = c;
  }
  return column_of;
}

void assign_cluster(const std::vector<Point>& truth, const std::vector<Point>& found, double gate_m,
                    const Cluster& cluster, Assignment& assignment) {
  const bool truth_is_rows = cluster.truth.size() <= cluster.found.size();
  const auto& rows = truth_is_rows ? cluster.truth : cluster.found;
  const auto& columns = truth_is_rows ? cluster.found : cluster.truth;
  // Above the cost of all pairs within the gate together, so that the number of pairs has priority.
  const double forbidden = gate_m * gate_m * static_cast<double>(rows.size() + 1);
  Matrix cost(rows.size(), std::vector<double>(columns.size(), forbidden));
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const std::size_t t = truth_is_rows ? rows[r] : columns[c];
      const std::size_t f = truth_is_rows ? columns[c] : rows[r];
      const double distance_m2 = squared_distance_m2(truth[t], found[f]);
      if (distance_m2 <= gate_m * gate_m) cost[r][c] = distance_m2;
    }
  }
  const std::vector<std::size_t> column_of = hungarian(cost);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (cost[r][column_of[r]] >= forbidden) continue;
    const std::size_t t = truth_is_rows ? rows[r] : columns[column_of[r]];
    const std::size_t f = truth_is_rows ? columns[column_of[r]] : rows[r];
    assignment[t] = static_cast<std::ptrdiff_t>(f);
  }
}

}  // namespace

Assignment assign(const std::vector<Point>& truth, const std::vector<Point>& found, double gate_m) {
  if (!(gate_m > 0.0) || !std::isfinite(gate_m)) {
    throw std::invalid_argument("assign: the gate must be positive");
  }
  require_finite(truth);
  require_finite(found);
  Assignment assignment(truth.size(), kUnmatched);
  for (const Cluster& cluster : clusters_within(truth, found, gate_m)) {
    assign_cluster(truth, found, gate_m, cluster, assignment);
  }
  return assignment;
}

}  // namespace orchard::evaluation
