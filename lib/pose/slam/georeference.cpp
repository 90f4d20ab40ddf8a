// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/georeference.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/pose2.hpp"
#include "geometry/rigid_fit2.hpp"

namespace orchard::pose {
using geometry::between;
using geometry::compose;
using geometry::compose_jacobian_second;
using geometry::rotation;
using geometry::transform;

namespace {

constexpr std::size_t kNumPositionsMin = 4;

}  // namespace

std::optional<Eigen::Vector3d> find_georeference(const SlamGraph& graph, double travel_m) {
  std::vector<Eigen::Vector2d> p_graph, p_map;
  double sd_m = 0.0;
  for (const Keyframe& k : graph.keyframes) {
    for (const AbsolutePosition& position : k.positions) {
      const Eigen::Vector3d T_graph_then = compose(k.T_map_base, position.T_keyframe_then);
      if (position.has_yaw) {
        Eigen::Vector3d T_map_then(0.0, 0.0, position.yaw_rad);
        T_map_then.head<2>() = position.p_map - rotation(position.yaw_rad) * position.lever_base_m;
        const Eigen::Vector3d back = between(T_graph_then, Eigen::Vector3d::Zero());
        return compose(T_map_then, back);
      }
      p_graph.push_back(transform(T_graph_then, position.lever_base_m));
      p_map.push_back(position.p_map);
      sd_m = std::max(sd_m, std::sqrt(0.5 * position.covariance.trace()));
    }
  }
  if (p_graph.size() < kNumPositionsMin) return std::nullopt;
  const geometry::RigidFit2 fit = geometry::fit_rigid(p_map, p_graph);
  double reach_m = 0.0;
  for (const Eigen::Vector2d& p : p_graph) reach_m = std::max(reach_m, (p - fit.mean_b).norm());
  // The baseline must be long against the noise of the positions.
  if (2.0 * reach_m < std::max(travel_m, 20.0 * sd_m)) return std::nullopt;
  for (std::size_t i = 0; i < p_graph.size(); ++i) {
    const double off_m = (transform(fit.T_a_b, p_graph[i]) - p_map[i]).norm();
    if (off_m > 1.0 + 3.0 * sd_m) return std::nullopt;
  }
  return fit.T_a_b.vector();
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
