// SPDX-License-Identifier: BSD-3-Clause
#include "system/real_recordings/clear_trees.hpp"
#include "geometry/pose2.hpp"
#include "geometry/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <map>
#include <utility>

#include "system/real_recordings/free_standing.hpp"

namespace orchard::test {
namespace {

constexpr double kKernel_m = 0.15;
constexpr double kCell_m = 0.5;
constexpr int kRounds = 15;
constexpr double kClearSupport = 15.0;
constexpr double kApart_m = 1.0;
constexpr double kReach_m = 0.5;
constexpr int kObservationsMin = 10;

struct Point {
  double x_m = 0.0;
  double y_m = 0.0;
};

double distance_m(const Point& a, const Point& b) {
  return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m);
}

std::vector<Point> observations(const std::vector<io::SensorMessage>& recording) {
  std::map<std::int64_t, pose::PoseFix> track;
  for (const io::SensorMessage& message : recording) {
    if (const auto* fix = std::get_if<pose::PoseFix>(&message)) track[fix->utime] = *fix;
  }
  std::vector<Point> points;
  for (const io::SensorMessage& message : recording) {
    const auto* scan = std::get_if<laser::Scan>(&message);
    if (scan == nullptr) continue;
    const auto base = track.find(scan->utime);
    if (base == track.end()) continue;
    const pose::PoseFix& fix = base->second;
    for (const Eigen::Vector2d& p : free_standing(*scan)) {
      const Eigen::Vector2d p_map =
          geometry::transform(geometry::Pose2{fix.x_m, fix.y_m, fix.yaw_rad}, p);
      points.push_back({p_map.x(), p_map.y()});
    }
  }
  return points;
}

/// Density of points, and the way up in it.
class Density {
 public:
  explicit Density(const std::vector<Point>& points) {
    for (const Point& p : points) cells_[cell_of(p)].push_back(p);
  }

  ClearTree climb(Point at) const {
    double total = 0.0;
    for (int round = 0; round < kRounds; ++round) {
      total = 0.0;
      Point sum;
      const auto [cx, cy] = cell_of(at);
      for (int x = cx - 1; x <= cx + 1; ++x) {
        for (int y = cy - 1; y <= cy + 1; ++y) {
          const auto cell = cells_.find({x, y});
          if (cell == cells_.end()) continue;
          for (const Point& p : cell->second) {
            const double u = distance_m(p, at) / kKernel_m;
            const double weight = std::exp(-0.5 * u * u);
            total += weight;
            sum.x_m += weight * p.x_m;
            sum.y_m += weight * p.y_m;
          }
        }
      }
      at = {sum.x_m / total, sum.y_m / total};
    }
    return {at.x_m, at.y_m, total};
  }

 private:
  static std::pair<int, int> cell_of(const Point& p) {
    return {static_cast<int>(std::floor(p.x_m / kCell_m)),
            static_cast<int>(std::floor(p.y_m / kCell_m))};
  }

  std::map<std::pair<int, int>, std::vector<Point>> cells_;
};

template <class... Values>
std::string text(const char* format, Values... values) {
  char line[160];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

}  // namespace

std::vector<ClearTree> find_clear_trees(const std::vector<io::SensorMessage>& recording,
                                        double fraction) {
  const std::vector<Point> points = observations(recording);
  const Density density(points);
  std::vector<ClearTree> peaks;
  for (const Point& p : points) peaks.push_back(density.climb(p));
  std::stable_sort(peaks.begin(), peaks.end(),
                   [](const ClearTree& a, const ClearTree& b) { return a.support > b.support; });
  std::vector<ClearTree> apart;
  for (const ClearTree& peak : peaks) {
    if (peak.support < fraction * kClearSupport) break;
    const bool is_known = std::any_of(apart.begin(), apart.end(), [&](const ClearTree& other) {
      return distance_m({peak.x_m, peak.y_m}, {other.x_m, other.y_m}) <= kApart_m;
    });
    if (!is_known) apart.push_back(peak);
  }
  return apart;
}

int ClearTreeComparison::num_with(int num) const {
  return static_cast<int>(std::count(num_landmarks.begin(), num_landmarks.end(), num));
}

int ClearTreeComparison::num_doubled() const {
  return static_cast<int>(
      std::count_if(num_landmarks.begin(), num_landmarks.end(), [](int num) { return num > 1; }));
}

double ClearTreeComparison::median_distance_m() const { return geometry::median(distances_m); }

bool is_same_place(const ClearTree& a, const ClearTree& b) {
  return distance_m({a.x_m, a.y_m}, {b.x_m, b.y_m}) < kReach_m;
}

ClearTreeComparison compare(const std::vector<ClearTree>& clear_trees,
                            const std::vector<mapping::Landmark>& map, double fraction) {
  std::vector<Point> landmarks;
  for (const mapping::Landmark& l : map) {
    if (l.label != detection::Label::kTree || l.num_observations < fraction * kObservationsMin)
      continue;
    landmarks.push_back({l.x_m, l.y_m});
  }
  ClearTreeComparison comparison;
  comparison.num_tree_landmarks = static_cast<int>(landmarks.size());
  for (const ClearTree& tree : clear_trees) {
    std::vector<double> near_m;
    for (const Point& l : landmarks) {
      const double away_m = distance_m(l, {tree.x_m, tree.y_m});
      if (away_m < kReach_m) near_m.push_back(away_m);
    }
    comparison.num_landmarks.push_back(static_cast<int>(near_m.size()));
    if (near_m.size() == 1) comparison.distances_m.push_back(near_m.front());
  }
  std::sort(comparison.distances_m.begin(), comparison.distances_m.end());
  return comparison;
}

std::string report(const std::vector<ClearTree>& clear_trees,
                   const ClearTreeComparison& comparison) {
  std::string all =
      text("clear trees: %zu; with one tree landmark: %d, none: %d, more: %d\n", clear_trees.size(),
           comparison.num_with(1), comparison.num_with(0), comparison.num_doubled());
  if (!comparison.distances_m.empty()) {
    all += text("distance to the peak: median %.3f m, most %.3f m\n",
                comparison.median_distance_m(), comparison.distances_m.back());
  }
  all += text("tree landmarks seen ten times or more: %d\n", comparison.num_tree_landmarks);
  return all + report_of_misses(clear_trees, comparison);
}

std::string report_of_misses(const std::vector<ClearTree>& clear_trees,
                             const ClearTreeComparison& comparison) {
  std::string all;
  for (std::size_t i = 0; i < clear_trees.size(); ++i) {
    const int num = comparison.num_landmarks[i];
    if (num == 1) continue;
    all += text("  (%.2f, %.2f), support %.0f: %d landmarks\n", clear_trees[i].x_m,
                clear_trees[i].y_m, clear_trees[i].support, num);
  }
  return all;
}

}  // namespace orchard::test
