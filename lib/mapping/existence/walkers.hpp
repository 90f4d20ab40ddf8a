// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mapping/landmark_record.hpp"
#include "mapping/map_state.hpp"

namespace orchard::mapping {

/// Paths of people who walked while the robot observed them: objects as thin as legs, followed from
/// scan to scan on a straight line longer than a stance.
///
/// The foot of a walker rests for a few scans at each step and so becomes a landmark. Where no
/// later scan looks (behind the robot, at the start and end of a drive) there is no other evidence
/// against it.
class WalkerTracks {
 public:
  explicit WalkerTracks(const MapState& map);

  /// Whether a landmark was observed only while a person walked through its position.
  bool is_footprint(const LandmarkRecord& record) const;

 private:
  struct Step {
    std::int64_t utime = 0;
    Eigen::Vector2d p_map{0, 0};
  };
  bool passes(const Step& seen) const;

  const MapState& map_;
  std::vector<Step> steps_;  ///< of all paths, in order of time
};

}  // namespace orchard::mapping
