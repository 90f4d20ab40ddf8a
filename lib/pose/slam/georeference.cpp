// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/georeference.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pose/planar.hpp"

namespace orchard::pose {
namespace {

constexpr std::size_t kNumPositionsMin = 4;

struct PositionPair {
  Eigen::Vector2d p_graph;
  Eigen::Vector2d p_map;
  double sd_m;
};

}  // namespace

std::optional<Eigen::Vector3d> find_georeference(const SlamGraph& graph, double travel_m) {
  std::vector<PositionPair> pairs;
  for (const Keyframe& k : graph.keyframes) {
    for (const AbsolutePosition& position : k.positions) {
      const Eigen::Vector3d T_graph_then = compose(k.T_map_base, position.T_keyframe_then);
      if (position.has_yaw) {
        Eigen::Vector3d T_map_then(0.0, 0.0, position.yaw_rad);
        T_map_then.head<2>() = position.p_map - rotation(position.yaw_rad) * position.lever_base_m;
        const Eigen::Vector3d back = between(T_graph_then, Eigen::Vector3d::Zero());
        return compose(T_map_then, back);
      }
      pairs.push_back({transform(T_graph_then, position.lever_base_m), position.p_map,
                       std::sqrt(0.5 * position.covariance.trace())});
    }
  }
  if (pairs.size() < kNumPositionsMin) return std::nullopt;
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  Eigen::Vector2d to = Eigen::Vector2d::Zero();
  for (const PositionPair& pair : pairs) {
    from += pair.p_graph / static_cast<double>(pairs.size());
    to += pair.p_map / static_cast<double>(pairs.size());
  }
  double s = 0.0;
  double c = 0.0;
  double reach_m = 0.0;
  double sd_m = 0.0;
  for (const PositionPair& pair : pairs) {
    const Eigen::Vector2d a = pair.p_graph - from;
    const Eigen::Vector2d b = pair.p_map - to;
    s += a.x() * b.y() - a.y() * b.x();
    c += a.dot(b);
    reach_m = std::max(reach_m, a.norm());
    sd_m = std::max(sd_m, pair.sd_m);
  }
  // The baseline must be long against the noise of the positions.
  if (2.0 * reach_m < std::max(travel_m, 20.0 * sd_m)) return std::nullopt;
  Eigen::Vector3d T_map_graph(0.0, 0.0, std::atan2(s, c));
  T_map_graph.head<2>() = to - rotation(T_map_graph.z()) * from;
  for (const PositionPair& pair : pairs) {
    if ((transform(T_map_graph, pair.p_graph) - pair.p_map).norm() > 1.0 + 3.0 * sd_m) {
      return std::nullopt;
    }
  }
  return T_map_graph;
}

void apply_georeference(const Eigen::Vector3d& T_map_graph, SlamGraph& graph) {
  const Eigen::Matrix3d F = compose_jacobian_second(T_map_graph);
  for (Keyframe& k : graph.keyframes) {
    k.T_map_base = compose(T_map_graph, k.T_map_base);
    k.covariance = F * k.covariance * F.transpose();
    k.local_covariance = F * k.local_covariance * F.transpose();
  }
  const Eigen::Matrix2d R = F.topLeftCorner<2, 2>();
  for (SlamLandmark& l : graph.landmarks) {
    l.p_map = transform(T_map_graph, l.p_map);
    l.information = R * l.information * R.transpose();
  }
  graph.georeferenced = true;
}

}  // namespace orchard::pose
