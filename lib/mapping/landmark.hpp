// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "detection/detection.hpp"

namespace orchard::mapping {

/// A landmark (tree, post or other object) as published (map frame).
struct Landmark {
  std::int32_t id = 0;
  detection::Label label = detection::Label::kUnseen;
  std::int32_t num_observations = 0;
  double x_m = 0.0;
  double y_m = 0.0;
  double se_x_m = 0.0;  ///< standard error of the mean, Shalal et al. 2013 eq. 13
  double se_y_m = 0.0;
  std::array<double, 3> covariance{};  ///< of the position: xx xy yy [m2]
  double width_m = 0.0;
  double width_sd_m = 0.0;  ///< standard error of width_m; 0 = unknown (not in MAP messages)
  /// Height of the ground at the trunk above map's origin, whose altitude is that of the
  /// georeference; known if z_sd_m > 0. Not in MAP messages.
  double z_m = 0.0;
  double z_sd_m = 0.0;
  /// Length of a hedge or wall, centred on x_m, y_m; 0 = round. Not in MAP messages, which contain
  /// the separate parts.
  double length_m = 0.0;
  double direction_rad = 0.0;  ///< direction of the length, in (-pi/2, pi/2]
  double roc_mean = 0.0;       ///< mean roc_tree over its observations
  double probability = 0.0;    ///< probability of being a tree
  std::int32_t row = 0;        ///< 0 = unknown
  std::int32_t position = 0;   ///< 0 = unknown
};

/// Landmarks changed by one scan, plus some unchanged ones for the slow refresh of the whole map.
struct MapTile {
  std::int64_t utime = 0;
  std::int32_t seq = 0;
  std::int32_t num_landmarks_total = 0;
  std::vector<Landmark> landmarks;
  std::vector<std::int32_t> removed_ids;
};

}  // namespace orchard::mapping
