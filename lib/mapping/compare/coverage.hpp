// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/compare/visibility_grid.hpp"

namespace orchard::mapping {

/// Detection probability of one drive at each position.
///
/// Learnt from the drive's own map: observations of its trees per second in view, by distance, and
/// how much trees differ in that. So range, camera view and high grass need not be configured. No
/// detection at a position often in view is evidence that nothing stands there; an occluded
/// position, or one out of range, is no evidence.
class DetectionMap {
 public:
  /// Nothing is known about the drive.
  DetectionMap() = default;
  DetectionMap(const std::vector<Landmark>& landmarks,
               const std::vector<std::vector<pose::PoseEstimate>>& trajectories,
               const SensorView& view);

  bool is_known() const { return is_known_; }

  /// Expected number of observations of an ordinary tree there.
  double expected_observations(const Eigen::Vector2d& p_map) const;

  /// Relative detection rate of a landmark of this map, 1 for an ordinary tree; within [0.1, 1].
  double visibility(const Landmark& landmark) const;

  /// Fraction of its chances at which a landmark of this map was seen, in (0, 1]; 1 for what is
  /// seen as often as the trees that are seen well, and where nothing is known.
  double rate(const Landmark& landmark) const;

  /// Probability that this drive maps an object there that another one saw at `rate` of its
  /// chances, if it stands there still; 1 when nothing is known.
  double probability_mapped(const Eigen::Vector2d& p_map, double rate) const;

  /// Probability that a thing of another map, whose place in this one is `p_map`, stands there
  /// still and is not in this map: hidden, out of reach, or shown at some visits only. 1 when
  /// nothing is known.
  double probability_missed(const Eigen::Vector2d& p_map, const DetectionMap& other,
                            const Landmark& of_other) const;

  /// Probability that an object there of that visibility would have been missed, in [0, 1]; 1 when
  /// nothing is known. The number of observations is negative binomial, as overdispersed as in this
  /// map.
  double probability_missed(const Eigen::Vector2d& p_map, double visibility = 1.0) const;

 private:
  bool is_known_ = false;
  std::vector<VisibilityGrid> raster_;  ///< one, or none
  std::array<double, VisibilityGrid::kRangeEnds_m.size()> rate_per_s_{};
  double clear_visibility_ = 1.0;  ///< of trees that are seen well, against the usual one
  double num_mapped_min_ = 1.0;    ///< observations of what is in the map, at least
  double shape_ = 1.0;             ///< of the negative binomial
};

}  // namespace orchard::mapping
