// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/submaps.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "geometry/pose2.hpp"
#include "pose/graph/calibration.hpp"
#include "pose/tuning.hpp"

namespace orchard::pose {
using geometry::between;
using geometry::compose;
using geometry::compose_jacobian_first;
using geometry::compose_jacobian_second;
using geometry::rotation;
using geometry::transform;

namespace {

// derived: two landmarks determine the pose of a keyframe.
constexpr int kPlacedBy = 2;

bool is_blind(const Eigen::Matrix3d& P) {
  return std::max(P(0, 0), P(1, 1)) > kRigidMotionSd_m * kRigidMotionSd_m ||
         P(2, 2) > kRigidMotionSd_rad * kRigidMotionSd_rad;
}

/// Joins two successive motions, with the derivative by the odometry calibration.
RelativeMotion joined(const RelativeMotion& a, const RelativeMotion& b) {
  RelativeMotion both = a;
  const Eigen::Vector3d then = b.delta_with(a.calibration);
  both.append(then, b.covariance);
  both.calibration_jacobian += compose_jacobian_second(a.delta) * b.calibration_jacobian;
  both.travel_m = a.travel_m + b.travel_m;
  return both;
}

/// True if the keyframe observed at least kPlacedBy landmarks that other keyframes observed, too.
bool is_placed(const SlamGraph& graph, const Keyframe& keyframe) {
  int num = 0;
  for (const SlamObservation& o : keyframe.observations) {
    num += graph.landmarks[o.landmark].keyframes.size() >= 2 ? 1 : 0;
  }
  return num >= kPlacedBy;
}

/// Returns the first keyframe of each submap. A submap ends where its shape would depend on
/// uncertain wheel odometry alone: before the first tree, and between two groups of trees.
std::vector<int> beginnings(const SlamGraph& graph, const SlamConfig& config) {
  std::vector<int> first{0};
  const Eigen::Matrix3d unknown =
      CalibrationPrior::initial_sd(config).array().square().matrix().asDiagonal();
  RelativeMotion alone;  // motion by the wheels since the last keyframe with is_placed()
  for (int k = 1; k < static_cast<int>(graph.keyframes.size()); ++k) {
    const Keyframe& keyframe = graph.keyframes[k];
    alone = alone.travel_m > 0.0 ? joined(alone, keyframe.motion) : keyframe.motion;
    const Eigen::Matrix3d& J = alone.calibration_jacobian;
    const bool placed = is_placed(graph, keyframe);
    const bool blind = is_blind(keyframe.motion.covariance) ||
                       (!placed && is_blind(alone.covariance + J * unknown * J.transpose()));
    if (keyframe.travel_m - graph.keyframes[first.back()].travel_m > config.submap_length_m ||
        blind) {
      first.push_back(k);
    }
    if (blind || placed) alone = RelativeMotion{};
  }
  return first;
}

/// Adds a keyframe's observation to those of its submap. `at` holds the index of each landmark's
/// observation in `sums`, -1 for none.
void add_observation(const SlamObservation& seen, const Eigen::Vector3d& T_submap_keyframe,
                     std::vector<SlamObservation>& sums, std::vector<int>& at) {
  int& slot = at[seen.landmark];
  if (slot < 0) {
    slot = static_cast<int>(sums.size());
    SlamObservation fresh;
    fresh.landmark = seen.landmark;
    fresh.floor_sd_m = kSubmapRigiditySd_m;
    sums.push_back(fresh);
  }
  SlamObservation& sum = sums[slot];
  const Eigen::Matrix2d R = rotation(T_submap_keyframe.z());
  const Eigen::Matrix2d W = R * seen.covariance().inverse() * R.transpose();
  sum.information += W;
  sum.information_m += W * transform(T_submap_keyframe, seen.position());
  sum.num_scans += seen.num_scans;
}

/// Transfers relative poses of keyframes to their submaps; those within one submap are dropped.
void add_relative_poses(const SlamGraph& graph, SubmapGraph& out) {
  for (const RelativePose& r : graph.relative_poses) {
    RelativePose s;
    s.from = out.submap_of[r.from];
    s.to = out.submap_of[r.to];
    if (s.from == s.to) continue;
    const auto in_submap = [&](int k, int submap) {
      return between(graph.keyframes[out.keyframes[submap]].T_map_base,
                     graph.keyframes[k].T_map_base);
    };
    const Eigen::Vector3d T_s_from = in_submap(r.from, s.from);
    const Eigen::Vector3d T_to_s = geometry::inverse(in_submap(r.to, s.to));
    s.T_from_to = compose(compose(T_s_from, r.T_from_to), T_to_s);
    const Eigen::Matrix3d F =
        compose_jacobian_second(T_s_from) * compose_jacobian_first(r.T_from_to, T_to_s);
    s.covariance = F * r.covariance * F.transpose();
    out.graph.relative_poses.push_back(s);
  }
}

/// Moves a pose T rigidly with its submap, from `was` to `now`.
Eigen::Vector3d moved(const Eigen::Vector3d& T, const Eigen::Vector3d& was,
                      const Eigen::Vector3d& now) {
  return compose(now, between(was, T));
}

}  // namespace

SubmapGraph submaps_of(const SlamGraph& graph, const SlamConfig& config) {
  const int num_keyframes = static_cast<int>(graph.keyframes.size());
  const std::vector<int> first = beginnings(graph, config);
  SubmapGraph out;
  out.graph.calibrations = graph.calibrations;
  out.graph.calibration_walk_sd = graph.calibration_walk_sd;
  out.graph.georeferenced = graph.georeferenced;
  out.graph.receiver_errors = graph.receiver_errors;
  out.graph.receiver = graph.receiver;
  out.graph.observation_noise = graph.observation_noise;
  out.graph.landmarks.resize(graph.landmarks.size());
  for (std::size_t l = 0; l < graph.landmarks.size(); ++l) {
    out.graph.landmarks[l].p_map = graph.landmarks[l].p_map;
    out.graph.landmarks[l].seen_m = graph.landmarks[l].seen_m;
  }
  std::vector<int> at(graph.landmarks.size(), -1);
  int before = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const int end = i + 1 < first.size() ? first[i + 1] : num_keyframes;
    const int middle = i == 0 ? 0 : (first[i] + end) / 2;  // the map's origin stays where it is
    const Keyframe& own = graph.keyframes[middle];
    Keyframe submap;
    submap.utime = own.utime;
    submap.T_map_base = own.T_map_base;
    submap.covariance = own.covariance;
    submap.travel_m = own.travel_m;
    submap.calibration = own.calibration;
    for (int k = before + 1; k <= middle; ++k) {
      const RelativeMotion& motion = graph.keyframes[k].motion;
      submap.motion = k == before + 1 ? motion : joined(submap.motion, motion);
    }
    std::vector<SlamObservation>& sums = submap.observations.edit();
    for (int k = first[i]; k < end; ++k) {
      const Keyframe& keyframe = graph.keyframes[k];
      const Eigen::Vector3d T_submap_keyframe = between(own.T_map_base, keyframe.T_map_base);
      for (const SlamObservation& s : keyframe.observations) {
        add_observation(s, T_submap_keyframe, sums, at);
      }
      for (AbsolutePosition position : keyframe.positions) {
        position.T_keyframe_then = compose(T_submap_keyframe, position.T_keyframe_then);
        submap.positions.push_back(position);
      }
      out.submap_of.push_back(static_cast<int>(i));
    }
    sums.shrink_to_fit();
    for (const SlamObservation& s : sums) {
      at[s.landmark] = -1;
      out.graph.landmarks[s.landmark].keyframes.push_back(static_cast<int>(i));
    }
    out.keyframes.push_back(middle);
    out.graph.keyframes.push_back(std::move(submap));
    before = middle;
  }
  add_relative_poses(graph, out);
  return out;
}

void back_substitute(const SubmapGraph& solved, SlamGraph& graph) {
  std::vector<Eigen::Vector3d> was;
  for (const int k : solved.keyframes) was.push_back(graph.keyframes[k].T_map_base);
  const auto now = [&](int submap) -> const Keyframe& { return solved.graph.keyframes[submap]; };
  int next = 0;  // first submap whose defining keyframe is later than k
  for (int k = 0; k < static_cast<int>(graph.keyframes.size()); ++k) {
    while (next < static_cast<int>(was.size()) && solved.keyframes[next] <= k) ++next;
    Keyframe& keyframe = graph.keyframes[k];
    const int submap = solved.submap_of[k];
    const Eigen::Vector3d& from = now(submap).T_map_base;
    if (submap > 0 || graph.georeferenced) {  // the origin is fixed: its covariance is zero, not
                                              // that of its neighbours
      const Eigen::Matrix3d F =
          compose_jacobian_first(from, between(was[submap], keyframe.T_map_base));
      keyframe.covariance = F * now(submap).covariance * F.transpose();
      keyframe.calibration_cross = F * now(submap).calibration_cross;
      keyframe.calibration_covariance = now(submap).calibration_covariance;
    }
    const int a = next - 1;
    Eigen::Vector3d T = moved(keyframe.T_map_base, was[a], now(a).T_map_base);
    if (next < static_cast<int>(was.size())) {
      const double from_m = now(a).travel_m, to_m = now(next).travel_m;
      const double fraction = to_m > from_m ? (keyframe.travel_m - from_m) / (to_m - from_m) : 0.5;
      const Eigen::Vector3d by_next = moved(keyframe.T_map_base, was[next], now(next).T_map_base);
      T.head<2>() += fraction * (by_next - T).head<2>();
      T.z() = geometry::wrap_angle_rad(T.z() +
                                       fraction * geometry::wrap_angle_rad(by_next.z() - T.z()));
    }
    keyframe.T_map_base = T;
  }
  graph.older.forget();
  graph.calibrations = solved.graph.calibrations;
  graph.calibration_walk_sd = solved.graph.calibration_walk_sd;
  graph.receiver_errors = solved.graph.receiver_errors;
  graph.receiver = solved.graph.receiver;
  graph.observation_noise = solved.graph.observation_noise;
  std::vector<SlamGraph::Update> updates(graph.landmarks.size(), SlamGraph::Update::kNone);
  for (std::size_t l = 0; l < graph.landmarks.size(); ++l) {
    const std::size_t num_submaps = solved.graph.landmarks[l].keyframes.size();
    if (num_submaps >= 2) graph.landmarks[l].p_map = solved.graph.landmarks[l].p_map;
    // A landmark of a single submap is not an unknown of the submap graph: it moves with its
    // submap.
    if (num_submaps == 1) updates[l] = SlamGraph::Update::kPosition;
  }
  graph.update_landmarks(updates);
}

}  // namespace orchard::pose
