// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/slam_undo.hpp"

#include <cstddef>
#include <utility>

namespace orchard::pose {

SlamMap SlamUndo::light_copy(SlamMap& map) {
  std::vector<Keyframe> keyframes = std::move(map.graph.keyframes);
  std::vector<SlamLandmark> landmarks = std::move(map.graph.landmarks);
  map.graph.keyframes.clear();
  map.graph.landmarks.clear();
  SlamMap copy = map;
  map.graph.keyframes = std::move(keyframes);
  map.graph.landmarks = std::move(landmarks);
  return copy;
}

SlamUndo::SlamUndo(SlamMap& map) : map_(map), others_(light_copy(map)) {
  poses_.reserve(map.graph.keyframes.size());
  for (const Keyframe& k : map.graph.keyframes) {
    poses_.push_back({k.T_map_base, k.covariance, k.calibration_cross, k.calibration_covariance});
  }
  places_.reserve(map.graph.landmarks.size());
  for (const SlamLandmark& l : map.graph.landmarks) places_.push_back({l.p_map, l.information});
  map.graph.merges.emplace();
}

SlamUndo::~SlamUndo() { map_.graph.merges.reset(); }

void SlamUndo::restore() {
  SlamGraph& graph = map_.graph;
  graph.undo_merges();
  for (std::size_t k = 0; k < poses_.size(); ++k) {
    Keyframe& keyframe = graph.keyframes[k];
    keyframe.T_map_base = poses_[k].T_map_base;
    keyframe.covariance = poses_[k].covariance;
    keyframe.calibration_cross = poses_[k].calibration_cross;
    keyframe.calibration_covariance = poses_[k].calibration_covariance;
  }
  for (std::size_t l = 0; l < places_.size(); ++l) {
    graph.landmarks[l].p_map = places_[l].p_map;
    graph.landmarks[l].information = places_[l].information;
  }
  std::swap(others_.graph.keyframes, graph.keyframes);
  std::swap(others_.graph.landmarks, graph.landmarks);
  map_ = std::move(others_);
}

}  // namespace orchard::pose
