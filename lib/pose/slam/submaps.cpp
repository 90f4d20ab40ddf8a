// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/submaps.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pose/planar.hpp"

namespace orchard::pose {
namespace {

// A motion between keyframes that is less certain may not be held by what was seen on both sides.
constexpr double kBlindSdM = 0.05;
constexpr double kBlindSdRad = 0.02;
// By which the shape of a stretch is not what the keyframes' own corrections made it.
constexpr double kShapeSdM = 0.01;

bool is_blind(const RelativeMotion& motion) {
  const Eigen::Matrix3d& P = motion.covariance;
  return std::max(P(0, 0), P(1, 1)) > kBlindSdM * kBlindSdM || P(2, 2) > kBlindSdRad * kBlindSdRad;
}

/// First keyframe of each stretch.
std::vector<int> beginnings(const SlamGraph& graph, double length_m) {
  std::vector<int> first{0};
  for (int k = 1; k < static_cast<int>(graph.keyframes.size()); ++k) {
    const Keyframe& keyframe = graph.keyframes[k];
    if (keyframe.travel_m - graph.keyframes[first.back()].travel_m > length_m ||
        is_blind(keyframe.motion)) {
      first.push_back(k);
    }
  }
  return first;
}

/// One motion after another; owes to the wheels' errors what both do.
RelativeMotion joined(const RelativeMotion& a, const RelativeMotion& b) {
  RelativeMotion both = a;
  const Eigen::Vector3d then = b.delta_with(a.errors);
  both.append(then, b.covariance);
  both.error_jacobian += compose_jacobian_second(a.delta) * b.error_jacobian;
  both.travel_m = a.travel_m + b.travel_m;
  return both;
}

/// What one keyframe saw, as seen from another place.
void add_sighting(const SlamSighting& seen, const Eigen::Vector3d& T_stretch_keyframe,
                  Keyframe& stretch, std::vector<int>& at) {
  int& place = at[static_cast<std::size_t>(seen.landmark)];
  if (place < 0) {
    place = static_cast<int>(stretch.sightings.size());
    SlamSighting fresh;
    fresh.landmark = seen.landmark;
    fresh.floor_sd_m = kShapeSdM;
    stretch.sightings.push_back(fresh);
  }
  SlamSighting& sum = stretch.sightings[static_cast<std::size_t>(place)];
  const Eigen::Matrix2d R = rotation(T_stretch_keyframe.z());
  const Eigen::Matrix2d W = R * seen.covariance().inverse() * R.transpose();
  sum.information += W;
  sum.information_m += W * transform(T_stretch_keyframe, seen.position());
  sum.num_scans += seen.num_scans;
}

/// `is` a pose of the stretch once it lies at `now` and no longer at `was`.
Eigen::Vector3d moved(const Eigen::Vector3d& T, const Eigen::Vector3d& was,
                      const Eigen::Vector3d& now) {
  return compose(now, between(was, T));
}

}  // namespace

StretchGraph stretches_of(const SlamGraph& graph, const SlamConfig& config) {
  const int num_keyframes = static_cast<int>(graph.keyframes.size());
  const std::vector<int> first = beginnings(graph, config.solve_stretch_m);
  StretchGraph out;
  out.graph.calibrations = graph.calibrations;
  out.graph.placed = graph.placed;
  out.graph.landmarks.resize(graph.landmarks.size());
  for (std::size_t l = 0; l < graph.landmarks.size(); ++l) {
    out.graph.landmarks[l].p_map = graph.landmarks[l].p_map;
  }
  std::vector<int> at(graph.landmarks.size(), -1);
  int before = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const int end = i + 1 < first.size() ? first[i + 1] : num_keyframes;
    const int middle = i == 0 ? 0 : (first[i] + end) / 2;  // the map's origin stays where it is
    const Keyframe& own = graph.keyframes[middle];
    Keyframe stretch;
    stretch.utime = own.utime;
    stretch.T_map_base = own.T_map_base;
    stretch.covariance = own.covariance;
    stretch.travel_m = own.travel_m;
    stretch.calibration = own.calibration;
    for (int k = before + 1; k <= middle; ++k) {
      const RelativeMotion& motion = graph.keyframes[k].motion;
      stretch.motion = k == before + 1 ? motion : joined(stretch.motion, motion);
    }
    for (int k = first[i]; k < end; ++k) {
      const Keyframe& keyframe = graph.keyframes[k];
      const Eigen::Vector3d T_stretch_keyframe = between(own.T_map_base, keyframe.T_map_base);
      for (const SlamSighting& s : keyframe.sightings) {
        add_sighting(s, T_stretch_keyframe, stretch, at);
      }
      for (PlaceFix fix : keyframe.fixes) {
        fix.T_keyframe_then = compose(T_stretch_keyframe, fix.T_keyframe_then);
        stretch.fixes.push_back(fix);
      }
      out.stretch_of.push_back(static_cast<int>(i));
    }
    for (const SlamSighting& s : stretch.sightings) {
      at[static_cast<std::size_t>(s.landmark)] = -1;
      out.graph.landmarks[s.landmark].keyframes.push_back(static_cast<int>(i));
    }
    out.keyframes.push_back(middle);
    out.graph.keyframes.push_back(std::move(stretch));
    before = middle;
  }
  return out;
}

void take_over(const StretchGraph& solved, SlamGraph& graph) {
  std::vector<Eigen::Vector3d> was;
  for (const int k : solved.keyframes) was.push_back(graph.keyframes[k].T_map_base);
  const auto now = [&](int stretch) -> const Keyframe& { return solved.graph.keyframes[stretch]; };
  int next = 0;  // the first stretch whose pose is that of a later keyframe
  for (int k = 0; k < static_cast<int>(graph.keyframes.size()); ++k) {
    while (next < static_cast<int>(was.size()) && solved.keyframes[next] <= k) ++next;
    Keyframe& keyframe = graph.keyframes[k];
    const int stretch = solved.stretch_of[k];
    const Eigen::Vector3d& from = now(stretch).T_map_base;
    if (stretch > 0 || graph.placed) {  // the origin is held and says nothing of what is near it
      const Eigen::Matrix3d F =
          compose_jacobian_first(from, between(was[stretch], keyframe.T_map_base));
      keyframe.covariance = F * now(stretch).covariance * F.transpose();
    }
    const int a = next - 1;
    Eigen::Vector3d T = moved(keyframe.T_map_base, was[a], now(a).T_map_base);
    if (next < static_cast<int>(was.size())) {
      const double from_m = now(a).travel_m, to_m = now(next).travel_m;
      const double share = to_m > from_m ? (keyframe.travel_m - from_m) / (to_m - from_m) : 0.5;
      const Eigen::Vector3d by_next = moved(keyframe.T_map_base, was[next], now(next).T_map_base);
      T.head<2>() += share * (by_next - T).head<2>();
      T.z() =
          geometry::wrap_angle_rad(T.z() + share * geometry::wrap_angle_rad(by_next.z() - T.z()));
    }
    keyframe.T_map_base = T;
  }
  graph.calibrations = solved.graph.calibrations;
  for (std::size_t l = 0; l < graph.landmarks.size(); ++l) {
    const std::size_t num_stretches = solved.graph.landmarks[l].keyframes.size();
    if (num_stretches >= 2) graph.landmarks[l].p_map = solved.graph.landmarks[l].p_map;
    // what one stretch saw has no place in its graph, and goes with it
    if (num_stretches == 1) graph.replace(static_cast<int>(l), true);
  }
}

}  // namespace orchard::pose
