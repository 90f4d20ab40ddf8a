// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "pose/planar.hpp"
#include "pose/slam/trunk_slam.hpp"

// How TrunkSlam closes loops: when it asks, what it asks with, and how it undoes a wrong answer.
namespace orchard::pose {
namespace {

// So many landmarks from before the last stretch in view: the robot is where the map says.
constexpr int kAnchors = 3;
// A loop is closed anew only when the graph has grown by this share: the cost stays in proportion.
constexpr double kCloseGrowth = 0.02;
// Mean squared residual of what a closure has joined, in standard deviations, that refutes it.
constexpr double kRefuted2 = 9.0;

}  // namespace

/// None while the robot is among landmarks that it knows from before, or where there are no others.
std::optional<ClosureQuestion> TrunkSlam::closure_question() const {
  const Keyframe& now = map_.graph.keyframes.back();
  const double stretch_m = config_.closure_stretch_m;
  ClosureQuestion question;
  question.pivot = now.T_map_base.head<2>();
  question.covariance = now.covariance;
  const auto view = [&](int l) {
    const AssociationCandidate c = candidate(l);
    return ClosureLandmark{l, c.p_map, c.width_m, c.width_sd_m};
  };
  int num_anchors = 0;
  for (const int l : map_.local) {
    const SlamLandmark& landmark = map_.graph.landmarks[l];
    if (landmark.keyframes.size() < 2 || !landmark.confirmed) continue;
    const auto ago_m = [&](int k) { return now.travel_m - map_.graph.keyframes[k].travel_m; };
    if (ago_m(landmark.keyframes.back()) > stretch_m || landmark.keyframes.back() < map_.since)
      continue;
    if (ago_m(landmark.keyframes.front()) > 2.0 * stretch_m) {
      ++num_anchors;
    } else {
      question.recent.push_back(view(l));
    }
  }
  if (num_anchors >= kAnchors ||
      question.recent.size() < static_cast<std::size_t>(config_.closure_min_trees)) {
    return std::nullopt;
  }
  const Eigen::Matrix3d& P = now.covariance;
  const double reach_m =
      std::min(config_.closure_search_max_m, 4.0 * std::sqrt(std::max(P(0, 0), P(1, 1))) + 1.0) +
      4.0 * std::sqrt(P(2, 2)) * stretch_m;
  std::vector<int> old;
  for (const ClosureLandmark& r : question.recent) {
    for (const int l : map_.index.near(r.p_map, reach_m)) {
      const SlamLandmark& landmark = map_.graph.landmarks[l];
      if (!landmark.confirmed || landmark.keyframes.empty()) continue;
      const Keyframe& last = map_.graph.keyframes[landmark.keyframes.back()];
      if (now.travel_m - last.travel_m > stretch_m || landmark.keyframes.back() < map_.since) {
        old.push_back(l);
      }
    }
  }
  std::sort(old.begin(), old.end());
  old.erase(std::unique(old.begin(), old.end()), old.end());
  if (old.size() < static_cast<std::size_t>(config_.closure_min_trees)) return std::nullopt;
  for (const int l : old) question.old.push_back(view(l));
  for (int k = static_cast<int>(map_.graph.keyframes.size()) - 1; k >= map_.since; --k) {
    if (now.travel_m - map_.graph.keyframes[k].travel_m > stretch_m) break;
    question.path.push_back(map_.graph.keyframes[k].T_map_base.head<2>());
  }
  question.view_m = 0.5 * sight_.farthest_m();
  return question;
}

/// Whether the sightings of landmarks that were joined fit, now that everything has been solved.
bool TrunkSlam::agrees(const std::vector<std::pair<int, int>>& merged) const {
  double sum = 0.0;
  int n = 0;
  for (const auto& pair : merged) {
    const SlamLandmark& landmark = map_.graph.landmarks[pair.second];
    for (const int k : landmark.keyframes) {
      const Keyframe& keyframe = map_.graph.keyframes[k];
      for (const SlamSighting& s : keyframe.sightings) {
        if (s.landmark != pair.second) continue;
        const Eigen::Vector2d error =
            transform_back(keyframe.T_map_base, landmark.p_map) - s.position();
        sum += error.dot(s.covariance().inverse() * error);
        ++n;
      }
    }
  }
  return n > 0 && sum <= kRefuted2 * n;
}

void TrunkSlam::look_for_closure() {
  const int num_keyframes = static_cast<int>(map_.graph.keyframes.size());
  const double travel_m = map_.graph.keyframes.back().travel_m;
  if (travel_m - looked_travel_m_ < config_.closure_every_m ||
      num_keyframes < num_closed_ * (1.0 + kCloseGrowth)) {
    return;
  }
  looked_travel_m_ = travel_m;
  closure_ambiguous_ = false;
  const std::optional<ClosureQuestion> question = closure_question();
  if (!question) return;
  const Closure closure = find_closure(*question, config_);
  num_operations_ += closure.num_operations;
  closure_ambiguous_ = closure.ambiguous;
  if (!closure.found) return;
  for (const auto& [recent, old] : closure.same) {
    if (map_.graph.seen_together(recent, old)) return;
  }
  num_closed_ = num_keyframes;
  SlamMap before = map_;
  for (const auto& [recent, old] : closure.same) map_.graph.merge(recent, old);
  if (solve_all(WholeReason::kClosing) && agrees(closure.same)) {
    map_.since = 0;
    ++num_closures_;
    return;
  }
  map_ = std::move(before);
  ++num_refuted_;
}

}  // namespace orchard::pose
