// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace orchard::detection {

/// Today's light against that of the calibration: logs of what the trunks' channels are multiplied
/// by. All zero is as calibrated.
struct Light {
  double blue = 0.0;   ///< of blue over green
  double red = 0.0;    ///< of red over green
  double green = 0.0;  ///< of green: brightness
};

/// The part of a detector's models that follows while driving.
struct AdaptedModel {
  double width_mean_m = 0.0;  ///< mu of eq. 9
  Light light;
};

enum class AdaptationAction : std::int8_t {
  kStep = 1,      ///< the model moved
  kFreeze = 2,    ///< it stays until a later kResume
  kResume = 3,    ///< it follows again
  kRollback = 4,  ///< it went back to where confidence was last good
  kReset = 5,     ///< it went back to the calibrated model
};

enum class AdaptationReason : std::int8_t {
  kNone = 0,
  kTooFewTrees = 1,
  kSensorsDisagree = 2,      ///< the camera confirms too little of what the laser takes for trunks
  kTwoPopulations = 3,       ///< what teaches the model falls into two groups
  kConfidenceCollapsed = 4,  ///< far less is confirmed than where the model was last good
};

/// One entry of the log of adaptation: what happened, why, and the model from then on. ADAPTATION.
struct AdaptationStep {
  std::int64_t utime = 0;  ///< of the scan after which it holds [us]
  std::int32_t seq = 0;    ///< +1 per step
  AdaptationAction action = AdaptationAction::kStep;
  AdaptationReason reason = AdaptationReason::kNone;
  std::int32_t num_width_trees = 0;
  std::int32_t num_colour_trees = 0;
  double confident_share = 0.0;  ///< confirmed by the camera, of what the laser takes for trunks
  AdaptedModel model;
};

}  // namespace orchard::detection
