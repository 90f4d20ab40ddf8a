// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pose/graph/graph.hpp"

namespace orchard::pose {

/// One observation of a landmark, placed in map by the pose of its keyframe.
struct PlacedObservation {
  double travel_m = 0.0;  ///< path length up to the keyframe
  PositionSum position;   ///< by this observation alone, with the covariance that it claims
};

/// Learns from a solved graph how much landmarks scatter beyond what their observations claim.
///
/// Whoever drives past a plant sees other sides, shoots and neighbours of it before than after. So
/// its observations do not err independently of each other, and many of them tell less than their
/// number says. The position by the first half of a visit's observations is compared with that by
/// the second half: what is white averages out in both, what lasts does not.
class ObservationScatter {
 public:
  /// Adds the observations of one landmark, in order of keyframes. `seen_m`: the max range at which
  /// it was observed; after twice as long a travel without it the next visit begins.
  void add(const std::vector<PlacedObservation>& observations, double seen_m);

  /// Returns the variance of observations over what they claim, at least 1: no more than the visits
  /// surely show (3 sigma).
  double noise() const;

 private:
  std::vector<double> squares_;  ///< Mahalanobis distances of the halves of visits, squared
};

}  // namespace orchard::pose
