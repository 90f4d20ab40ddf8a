// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "geometry/visibility.hpp"
#include "pose/graph/graph.hpp"

namespace orchard::pose {

/// Min number of keyframes that confirm a landmark.
inline constexpr int kConfirmKeyframes = 3;

/// Returns the occlusion test for the objects that a keyframe observed, other than `except`.
inline geometry::OcclusionTest occlusion_by(const Keyframe& keyframe, const SlamGraph& graph,
                                            int except = -1) {
  geometry::OcclusionTest occlusion;
  for (const SlamObservation& o : keyframe.observations) {
    if (o.landmark != except) occlusion.add(o.position(), graph.landmarks[o.landmark].width_m);
  }
  return occlusion;
}

}  // namespace orchard::pose
