// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "pose/graph/graph.hpp"

namespace orchard::pose {

/// Min number of keyframes that confirm a landmark.
inline constexpr int kConfirmKeyframes = 3;

// An object occludes landmarks behind it (or up to kOcclusionDepth_m in front of its centre) within
// its own width plus a margin of the bearing.
inline constexpr double kOcclusionMargin_rad = 0.05;
inline constexpr double kOcclusionDepth_m = 0.3;

/// True if an object observed by `keyframe`, other than `except`, occludes a point in base.
inline bool is_hidden(const Eigen::Vector2d& p_base, const Keyframe& keyframe,
                      const SlamGraph& graph, int except = -1) {
  const double bearing_rad = std::atan2(p_base.y(), p_base.x());
  return std::any_of(
      keyframe.observations.begin(), keyframe.observations.end(), [&](const SlamObservation& o) {
        if (o.landmark == except) return false;
        const Eigen::Vector2d q = o.position();
        const double apart_rad = geometry::wrap_angle_rad(std::atan2(q.y(), q.x()) - bearing_rad);
        const double margin_rad =
            kOcclusionMargin_rad + 0.5 * graph.landmarks[o.landmark].width_m / q.norm();
        return q.norm() < p_base.norm() + kOcclusionDepth_m && std::abs(apart_rad) < margin_rad;
      });
}

}  // namespace orchard::pose
