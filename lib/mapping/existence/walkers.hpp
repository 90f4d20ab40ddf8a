// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mapping/landmark_record.hpp"
#include "mapping/map_state.hpp"

namespace orchard::mapping {

/// Where somebody walked while the robot looked: things as thin as legs that were followed from
/// scan to scan over more than people stand apart, straight on.
///
/// A walker's foot rests for a few scans at each step, and so becomes a landmark; where no scan
/// looks again, behind the robot and at a drive's beginning and end, nothing else tells.
class WalkedPaths {
 public:
  explicit WalkedPaths(const MapState& map);

  /// Whether a landmark was seen only while somebody walked through its place.
  bool have_left(const LandmarkRecord& record) const;

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
