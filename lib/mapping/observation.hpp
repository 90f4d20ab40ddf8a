// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace orchard::mapping {

/// One stored detection: everything needed to rebuild the landmarks after a pose correction.
struct Observation {
  std::int32_t scan = 0;       ///< index into the mapper's list of scans
  std::int32_t previous = -1;  ///< previous observation of the same landmark, or -1
  float x_base_m = 0.0f;       ///< centre in base
  float y_base_m = 0.0f;
  float sd_m = 0.0f;  ///< of the centre in map, per axis: detection and pose combined
  float roc_tree = 0.0f;
  float width_m = 0.0f;
  float width_sd_m = 0.0f;
  float covariance_xx = 0.0f;  ///< of the centre in base [m2]
  float covariance_xy = 0.0f;
  float covariance_yy = 0.0f;
  float probability_tree = 0.0f;
  float probability_object = 0.0f;
  std::int8_t label = 0;       ///< detection::Label
  std::int8_t occlusion = 0;   ///< bits of detection::Occlusion
  std::uint8_t num_beams = 0;  ///< 255 means 255 or more
  bool is_associated = false;  ///< part of a landmark's chain
};

}  // namespace orchard::mapping
