// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/slam_tracker.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/pose2.hpp"
#include "pose/motion.hpp"
#include "pose/slam/association.hpp"
#include "pose/slam/same_tree.hpp"
#include "pose/slam/slam_map.hpp"

namespace orchard::pose {
using geometry::between;
using geometry::compose_jacobian_second;
using geometry::inverse_transform;

namespace {

// derived: a single viewpoint confirms nothing [m]; a second of scans is not by chance; what misses
// as often as half as often again as it is seen is gone.
constexpr double kConfirmTravel_m = 1.0;
constexpr int kNumAmbiguousScans = 10;
constexpr int kNumContradictedScans = 10;
constexpr int kNumMissesMin = 3;
constexpr double kMissRatioMax = 1.5;

AssociationCandidate candidate(const SlamGraph& graph, int landmark) {
  const SlamLandmark& l = graph.landmarks[landmark];
  AssociationCandidate c;
  c.landmark = landmark;
  c.p_map = l.p_map;
  c.covariance = l.covariance();
  c.width_m = l.width_m;
  c.width_sd_m = l.width_sd_m();
  c.confirmed = l.confirmed;
  return c;
}

/// Returns the covariance of the newest pose in map: the smallest of its own (along the drive) and
/// those by way of older keyframes, to which reobserved landmarks or matched scans connect it.
Eigen::Matrix3d covariance_in_map(const SlamMap& map, int first) {
  const SlamGraph& graph = map.graph;
  const Keyframe& now = graph.keyframes.back();
  Eigen::Matrix3d best = now.covariance;
  const auto size = [](const Eigen::Matrix3d& P) { return P(0, 0) + P(1, 1); };
  for (const SlamObservation& o : now.observations) {
    const int old = graph.landmarks[o.landmark].keyframes.front();
    if (old >= std::min(first, map.num_solved)) continue;
    const Keyframe& then = graph.keyframes[old];
    const Eigen::Matrix3d back = compose_jacobian_second(then.T_map_base).transpose();
    const Eigen::Matrix3d P = compose_covariance(then.T_map_base, then.covariance,
                                                 between(then.T_map_base, now.T_map_base),
                                                 back * now.local_covariance * back.transpose());
    if (P.allFinite() && size(P) < size(best)) best = P;
  }
  for (auto r = graph.relative_poses.rbegin();
       r != graph.relative_poses.rend() && r->to == map.newest(); ++r) {
    const Keyframe& then = graph.keyframes[r->from];
    const Eigen::Matrix3d P = compose_covariance(
        then.T_map_base, then.covariance, between(then.T_map_base, now.T_map_base), r->covariance);
    if (P.allFinite() && size(P) < size(best)) best = P;
  }
  return best;
}

}  // namespace

void SlamTracker::start_session(SlamMap& map, bool was_lost) {
  map.start_session(was_lost);
  num_ambiguous_ = num_contradicted_ = 0;
}

void SlamTracker::start_keyframe(SlamMap& map) {
  num_scans_ = 0;
  const bool too_ambiguous = num_ambiguous_ >= kNumAmbiguousScans;
  if (map.local_sd_m() > config_.lost_sd_m || too_ambiguous) {
    start_session(map, too_ambiguous || num_contradicted_ > 0);
  }
  map.refresh_local();
}

/// Decides whether a scan without matches means that the robot is lost: no known landmark is
/// around, or known ones in view have been missing for many scans. Otherwise the objects are merely
/// new.
bool SlamTracker::is_elsewhere(const SlamMap& map) {
  const Eigen::Vector3d& T_map_base = map.graph.keyframes.back().T_map_base;
  bool any_known = false;
  bool any_missed = false;
  for (const int l : map.local) {
    const SlamLandmark& landmark = map.graph.landmarks[l];
    if (!landmark.confirmed) continue;
    any_known = true;
    any_missed |= map.coverage.in_view(inverse_transform(T_map_base, landmark.p_map));
  }
  if (any_missed) ++num_contradicted_;
  return !any_known || num_contradicted_ >= kNumContradictedScans;
}

void SlamTracker::match(const std::vector<ScanPoint>& points, SlamMap& map) {
  ++num_scans_;
  SlamGraph& graph = map.graph;
  std::vector<AssociationCandidate> candidates;
  candidates.reserve(map.local.size());
  for (const int l : map.local) candidates.push_back(candidate(graph, l));
  const Association found = associate(points, candidates, graph.keyframes.back().T_map_base,
                                      graph.keyframes.back().local_covariance, config_);
  num_operations_ += found.num_operations;
  num_ambiguous_ = found.ambiguous ? num_ambiguous_ + 1 : 0;
  num_matched_ = found.num_matched;
  if (num_matched_ > 0) num_contradicted_ = 0;
  if (num_matched_ == 0 && !points.empty() && !found.ambiguous &&
      map.local_sd_m() > kNewSessionSd_m && is_elsewhere(map)) {
    start_session(map, num_contradicted_ >= kNumContradictedScans);
  }
  for (std::size_t p = 0; p < points.size(); ++p) {
    int l = found.landmark[p];
    if (l < 0 && found.is_new[p]) l = map.add_landmark(points[p]);
    if (l < 0) continue;
    const ScanPoint& point = points[p];
    graph.add_observation(map.newest(), l, point.p_base, point.scan_covariance, point.floor_sd_m);
    SlamLandmark& landmark = graph.landmarks[l];
    landmark.add_width(point.width_m, point.width_sd_m);
    map.coverage.add_observation(point.p_base);
    if (landmark.confirmed) map.coverage.add_reobservation(point.p_base);
  }
}

bool SlamTracker::correct_window(SlamMap& map) {
  // The keyframe before the window is fixed; it is at the earliest the first one of the session.
  const int first = std::max(map.newest() - config_.window_keyframes, map.session_start + 1);
  if (first > map.newest()) return false;
  const WindowSolution solution = solve_window(
      map.graph, first, map.calibration_at(map.graph.keyframes[first].calibration), config_);
  num_operations_ += config_.window_keyframes;
  if (solution.solved) {
    Keyframe& now = map.graph.keyframes.back();
    now.local_covariance = solution.local_covariance;
    if (solution.in_map) set_joint_covariance(*solution.in_map, now);
    const Eigen::Matrix3d P = covariance_in_map(map, first);
    if (P != now.covariance) {
      now.covariance = P;
      now.calibration_cross.setZero();
    }
  }
  for (const int l : map.local) {
    const std::vector<int>& observed_by = map.graph.landmarks[l].keyframes;
    if (!observed_by.empty() && observed_by.back() >= first) {
      map.graph.update_landmark(l, observed_by.size() < 2);
    }
  }
  return true;
}

void SlamTracker::finish_keyframe(SlamMap& map) {
  SlamGraph& graph = map.graph;
  graph.drop_rare_observations(config_.detection_rate_min * num_scans_);
  const Keyframe& now = graph.keyframes.back();
  const geometry::OcclusionTest occlusion = occlusion_by(now, graph);
  for (const int l : map.local) {
    SlamLandmark& landmark = graph.landmarks[l];
    if (!landmark.alive || landmark.keyframes.empty()) continue;
    const int num_observed = static_cast<int>(landmark.keyframes.size());
    if (landmark.keyframes.back() == map.newest()) {
      const double span_m = now.travel_m - graph.keyframes[landmark.keyframes.front()].travel_m;
      landmark.confirmed =
          landmark.confirmed || (num_observed >= kConfirmKeyframes && span_m >= kConfirmTravel_m);
      continue;
    }
    const Eigen::Vector2d p_base = inverse_transform(now.T_map_base, landmark.p_map);
    if (map.coverage.in_view(p_base) && !occlusion.occludes(p_base)) ++landmark.num_misses;
    const bool gone =
        landmark.num_misses >= kNumMissesMin && landmark.num_misses > kMissRatioMax * num_observed;
    const double since_m = now.travel_m - graph.keyframes[landmark.keyframes.back()].travel_m;
    const bool transient =
        !landmark.confirmed && since_m > 0.5 * kRecentTravel_ranges * map.detection_range_m();
    if (gone || transient) graph.drop(l);
  }
}

}  // namespace orchard::pose
