// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/duplicate_landmarks.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <tuple>

#include "geometry/angles.hpp"
#include "geometry/pose2.hpp"
#include "pose/slam/occlusion.hpp"

namespace orchard::pose {
namespace {

/// The spacing of trees is this decile of the distances between neighbours observed together.
constexpr int kNearestOfTen = 1;

bool counts(const SlamLandmark& landmark) { return landmark.alive && landmark.confirmed; }

/// Returns the spacing of trees: a low quantile of the distances from each landmark to the nearest
/// one that was observed by the same keyframe [m]; 0 if there are too few.
double beside_m(const SlamGraph& graph, const geometry::PointGrid& index, double reach_m) {
  std::vector<double> nearest_m;
  for (int l = 0; l < static_cast<int>(graph.landmarks.size()); ++l) {
    if (!counts(graph.landmarks[l])) continue;
    double best_m = std::numeric_limits<double>::infinity();
    for (const int other : index.near(graph.landmarks[l].p_map, reach_m)) {
      if (other == l || !counts(graph.landmarks[other])) continue;
      const double apart_m = (graph.landmarks[other].p_map - graph.landmarks[l].p_map).norm();
      if (apart_m < best_m && graph.co_observed(l, other)) best_m = apart_m;
    }
    if (std::isfinite(best_m)) nearest_m.push_back(best_m);
  }
  if (nearest_m.size() < 10) return 0.0;
  const auto at =
      nearest_m.begin() + static_cast<std::ptrdiff_t>(nearest_m.size()) * kNearestOfTen / 10;
  std::nth_element(nearest_m.begin(), at, nearest_m.end());
  return *at;
}

/// True if `nearer`, at nearer_base, occludes the point p_base seen from base.
bool covers(const SlamLandmark& nearer, const Eigen::Vector2d& nearer_base,
            const Eigen::Vector2d& p_base) {
  const double apart_rad = geometry::wrap_angle_rad(std::atan2(nearer_base.y(), nearer_base.x()) -
                                                    std::atan2(p_base.y(), p_base.x()));
  return nearer_base.norm() < p_base.norm() &&
         std::abs(apart_rad) < 0.5 * nearer.width_m / nearer_base.norm();
}

/// Counts the keyframes that observed `seen` and should have observed `other`, too.
int num_missed(const SlamGraph& graph, int seen, int other, const SensorCoverage& coverage) {
  const SlamLandmark& a = graph.landmarks[seen];
  int num = 0;
  for (const int k : a.keyframes) {
    const Keyframe& keyframe = graph.keyframes[k];
    const Eigen::Vector2d p_base =
        geometry::inverse_transform(keyframe.T_map_base, graph.landmarks[other].p_map);
    const Eigen::Vector2d a_base = geometry::inverse_transform(keyframe.T_map_base, a.p_map);
    num += coverage.in_view(p_base) && !covers(a, a_base, p_base) &&
           !is_hidden(p_base, keyframe, graph, seen);
  }
  return num;
}

bool alike(const SlamLandmark& a, const SlamLandmark& b, const SlamConfig& config) {
  return std::abs(a.width_m - b.width_m) <=
         config.gate_sigma * std::hypot(a.width_sd_m(), b.width_sd_m()) + config.width_gate_m;
}

}  // namespace

std::vector<std::pair<int, int>> find_duplicate_landmarks(const SlamGraph& graph,
                                                          const geometry::PointGrid& index,
                                                          const SensorCoverage& coverage,
                                                          const SlamConfig& config) {
  const double near_m = 0.5 * beside_m(graph, index, coverage.range_max_m());
  std::vector<std::tuple<double, int, int>> pairs;
  for (int l = 0; l < static_cast<int>(graph.landmarks.size()); ++l) {
    const SlamLandmark& a = graph.landmarks[l];
    if (!counts(a)) continue;
    for (const int other : index.near(a.p_map, near_m)) {
      const SlamLandmark& b = graph.landmarks[other];
      const double apart_m = (b.p_map - a.p_map).norm();
      if (other <= l || !counts(b) || apart_m > near_m || !alike(a, b, config)) continue;
      if (graph.co_observed(l, other)) continue;
      const bool b_is_less = b.keyframes.size() < a.keyframes.size();
      const int less = b_is_less ? other : l, more = b_is_less ? l : other;
      if (num_missed(graph, less, more, coverage) < kConfirmKeyframes) continue;
      pairs.emplace_back(apart_m, less, more);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  std::vector<char> gone(graph.landmarks.size(), 0), stays(graph.landmarks.size(), 0);
  std::vector<std::pair<int, int>> duplicates;
  for (const auto& [apart_m, less, more] : pairs) {
    if (gone[less] || gone[more] || stays[less]) continue;
    gone[less] = stays[more] = 1;
    duplicates.emplace_back(less, more);
  }
  return duplicates;
}

}  // namespace orchard::pose
