// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace orchard::detection {

/// Present light relative to that of the calibration: logs of the factors of the trunks' colour
/// channels. All zero = as calibrated.
struct Light {
  double blue = 0.0;   ///< factor of blue over green (log)
  double red = 0.0;    ///< factor of red over green (log)
  double green = 0.0;  ///< factor of green (log): brightness
};

/// The detector's parameters that adapt while driving.
struct AdaptedModel {
  double width_mean_m = 0.0;  ///< mu of eq. 9
  Light light;
};

enum class AdaptationAction : std::int8_t {
  kStep = 1,      ///< the model changed
  kFreeze = 2,    ///< a model is frozen until kResume; repeated when the reason changes
  kResume = 3,    ///< the models adapt again
  kRollback = 4,  ///< the model returned to its last good state
  kReset = 5,     ///< the model returned to the calibration
};

enum class AdaptationReason : std::int8_t {
  kNone = 0,
  kTooFewTrees = 1,
  kSensorsDisagree = 2,      ///< the camera confirms too few of the laser's trunks
  kTwoPopulations = 3,       ///< the observations form two groups
  kConfidenceCollapsed = 4,  ///< the confirmed fraction is far below that of the last good state
};

/// One entry of the adaptation log: action, reason and the resulting model. Message ADAPTATION.
struct AdaptationStep {
  std::int64_t utime = 0;  ///< of the scan after which the model applies [us]
  std::int32_t seq = 0;    ///< +1 per step
  AdaptationAction action = AdaptationAction::kStep;
  AdaptationReason reason = AdaptationReason::kNone;
  std::int32_t num_width_trees = 0;
  std::int32_t num_colour_trees = 0;
  double confident_share = 0.0;  ///< fraction of the laser's trunks confirmed by the camera
  AdaptedModel model;
};

}  // namespace orchard::detection
