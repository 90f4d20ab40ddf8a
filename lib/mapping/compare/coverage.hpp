// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/compare/visibility_grid.hpp"

namespace orchard::mapping {

/// How likely a drive would have found a thing that stood at a place.
///
/// Learnt from the drive's own map: how often its trees were observed for each second of looking
/// at them from each distance, and how much trees differ in that. So a rig's reach, a camera's
/// narrow view or high grass need not be told. Nothing found where many looks went is evidence
/// that nothing stands there; a place behind a trunk or beyond reach is no evidence.
class DriveView {
 public:
  /// Nothing is known of where the drive looked.
  DriveView() = default;
  DriveView(const std::vector<Landmark>& landmarks,
            const std::vector<std::vector<pose::PoseEstimate>>& trajectories,
            const SensorView& view);

  bool is_known() const { return is_known_; }

  /// Observations that an ordinary tree there would have had.
  double expected_observations(const Eigen::Vector2d& p_map) const;

  /// How readily a landmark of this map was observed, of an ordinary tree's 1; within [0.1, 1].
  double visibility(const Landmark& landmark) const;

  /// That a thing there of that visibility would have been missed, in [0, 1]; 1 when nothing is
  /// known. Observations of one thing repeat each other, so their number is taken as a negative
  /// binomial of the spread that this map has.
  double probability_missed(const Eigen::Vector2d& p_map, double visibility = 1.0) const;

 private:
  bool is_known_ = false;
  std::vector<LookRaster> raster_;  ///< one, or none
  std::array<double, LookRaster::kRangeEnds_m.size()> rate_per_s_{};
  double shape_ = 1.0;  ///< of the negative binomial
};

}  // namespace orchard::mapping
