// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/loop_closer.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <set>

#include "geometry/pose2.hpp"
#include "pose/slam/local_map.hpp"
#include "pose/slam/slam_undo.hpp"

namespace orchard::pose {
using geometry::inverse_transform;

namespace {

/// Length of the latest part of the path whose landmarks are registered to older ones, in sight
/// ranges.
constexpr double kClosureSubmap_ranges = 2.5;

/// Travel between two searches for a loop closure [m].
constexpr double kClosureEvery_m = 2.0;

// If this many older landmarks are tracked now, the pose needs no loop closure.
constexpr int kNumAnchors = 3;
// A closure is tried again only when the graph has grown by this fraction, so that the cost of the
// solves stays proportional to the drive.
constexpr double kTryGrowth = 0.02;
// Mean squared Mahalanobis distance of merged observations above which a closure is undone.
constexpr double kRefutedDistance2 = 9.0;
// Max number of solves for landmarks that are merged at the end of the drive: bounds its time.
constexpr int kSolvesAtEndMax = 6;
// The search radius is this many sigmas of the pose plus a margin.
constexpr double kSearchSigmas = 4.0;
constexpr double kSearchMargin_m = 1.0;
// Cell size by which the positions that landmarks were seen from are thinned, in sight ranges.
constexpr double kPlaceCell_ranges = 0.2;

ClosureLandmark closure_landmark(const SlamGraph& graph, int landmark) {
  const SlamLandmark& l = graph.landmarks[landmark];
  return {landmark, l.p_map, l.width_m, l.width_sd_m(), l.seen_m};
}

/// Returns the positions from which landmarks were observed, one per cell of the ground.
std::vector<Eigen::Vector2d> places_of(const std::vector<int>& landmarks, const SlamGraph& graph,
                                       double cell_m) {
  std::set<std::pair<int, int>> known;
  std::vector<Eigen::Vector2d> places;
  for (const int l : landmarks) {
    for (const int k : graph.landmarks[l].keyframes) {
      const Eigen::Vector2d p = graph.keyframes[k].T_map_base.head<2>();
      const auto cell = [&](double x_m) { return static_cast<int>(std::floor(x_m / cell_m)); };
      if (known.emplace(cell(p.x()), cell(p.y())).second) places.push_back(p);
    }
  }
  return places;
}

/// Returns the mean squared Mahalanobis distance of a landmark's observations; call after a solve.
double mean_distance2(int landmark, const SlamGraph& graph) {
  const SlamLandmark& l = graph.landmarks[landmark];
  double sum = 0.0;
  int n = 0;
  for (const int k : l.keyframes) {
    const Keyframe& keyframe = graph.keyframes[k];
    for (const SlamObservation& o : keyframe.observations) {
      if (o.landmark != landmark) continue;
      const Eigen::Vector2d error = inverse_transform(keyframe.T_map_base, l.p_map) - o.position();
      sum += error.dot(o.covariance().inverse() * error);
      ++n;
    }
  }
  return n > 0 ? sum / n : std::numeric_limits<double>::infinity();
}

/// Inlier check after the solve: true if the observations of the merged landmarks fit on average.
bool is_supported(const std::vector<std::pair<int, int>>& merged, const SlamGraph& graph) {
  double sum = 0.0;
  std::size_t n = 0;
  for (const auto& pair : merged) {
    const std::size_t num = graph.landmarks[pair.second].keyframes.size();
    if (num > 0) sum += static_cast<double>(num) * mean_distance2(pair.second, graph);
    n += num;
  }
  return n > 0 && sum <= kRefutedDistance2 * static_cast<double>(n);
}

}  // namespace

/// Returns none while enough older landmarks are tracked, or if there are none to register to.
std::optional<ClosureQuery> LoopCloser::query(const SlamMap& map) const {
  const SlamGraph& graph = map.graph;
  const Keyframe& now = graph.keyframes.back();
  const double path_m = kClosureSubmap_ranges * map.detection_range_m();
  const auto ago_m = [&](int k) { return now.travel_m - graph.keyframes[k].travel_m; };
  ClosureQuery query;
  query.pivot = now.T_map_base.head<2>();
  query.covariance = now.covariance;
  int num_anchors = 0;
  for (const int l : map.local) {
    const SlamLandmark& landmark = graph.landmarks[l];
    if (landmark.keyframes.size() < 2 || !landmark.confirmed) continue;
    const int last = landmark.keyframes.back();
    if (ago_m(last) > path_m || last < map.session_start) continue;
    if (ago_m(landmark.keyframes.front()) > 2.0 * path_m) {
      num_anchors += ago_m(last) <= kTrackedTravel_ranges * map.detection_range_m() ? 1 : 0;
    } else {
      query.recent.push_back(closure_landmark(graph, l));
    }
  }
  if (num_anchors >= kNumAnchors || query.recent.size() < kClosureTreesMin) return std::nullopt;
  const Eigen::Matrix3d& P = now.covariance;
  const double radius_m = kSearchSigmas * std::sqrt(std::max(P(0, 0), P(1, 1))) + kSearchMargin_m +
                          kSearchSigmas * std::sqrt(P(2, 2)) * path_m;
  std::vector<int> old;
  for (const ClosureLandmark& r : query.recent) {
    for (const int l : map.index.near(r.p_map, radius_m)) {
      const SlamLandmark& landmark = graph.landmarks[l];
      if (!landmark.confirmed || landmark.keyframes.empty()) continue;
      const int last = landmark.keyframes.back();
      if (ago_m(last) > path_m || last < map.session_start) old.push_back(l);
    }
  }
  std::sort(old.begin(), old.end());
  old.erase(std::unique(old.begin(), old.end()), old.end());
  if (old.size() < kClosureTreesMin) return std::nullopt;
  for (const int l : old) query.old.push_back(closure_landmark(graph, l));
  for (int k = map.newest(); k >= map.session_start && ago_m(k) <= path_m; --k) {
    query.path.push_back(graph.keyframes[k].T_map_base.head<2>());
  }
  query.old_path = places_of(old, graph, kPlaceCell_ranges * map.detection_range_m());
  return query;
}

void LoopCloser::observe(SlamMap& map) {
  const double travel_m = map.graph.keyframes.back().travel_m;
  if (travel_m - last_travel_m_ < kClosureEvery_m ||
      static_cast<double>(map.graph.keyframes.size()) < num_keyframes_ * (1.0 + kTryGrowth)) {
    return;
  }
  last_travel_m_ = travel_m;
  close(map);
}

void LoopCloser::close(SlamMap& map) {
  ambiguous_ = false;
  const std::optional<ClosureQuery> query = this->query(map);
  if (!query) return;
  ++num_searches_;
  const Closure closure = find_closure(*query, config_);
  num_operations_ += closure.num_operations;
  ambiguous_ = closure.ambiguous;
  if (!closure.found) return;
  for (const auto& [recent, old] : closure.matches) {
    if (map.graph.co_observed(recent, old)) return;
  }
  num_keyframes_ = static_cast<int>(map.graph.keyframes.size());
  SlamUndo undo(map);
  for (const auto& [recent, old] : closure.matches) map.graph.merge(recent, old);
  const auto fits = [&](const SlamGraph& graph) { return is_supported(closure.matches, graph); };
  if (map.solve(SolveReason::kLoopClosure, fits)) {
    map.session_start = 0;
    map.lost = false;
    ++num_closures_;
    return;
  }
  undo.restore();
  ++num_refuted_;
}

void LoopCloser::merge_duplicate_landmarks(SlamMap& map) {
  for (int i = 0; i < kSolvesAtEndMax && map.num_merged > 0; ++i) {
    if (!map.solve(SolveReason::kDuplicatesAtEnd)) return;
  }
}

}  // namespace orchard::pose
