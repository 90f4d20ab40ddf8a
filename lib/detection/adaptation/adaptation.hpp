// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "detection/adaptation/adaptation_config.hpp"
#include "detection/adaptation/adaptation_step.hpp"
#include "vision/appearance/light.hpp"

namespace orchard::detection {

/// Measurements of one candidate in a scan and its image, from which the models adapt.
struct AdaptationObservation {
  double x_m = 0.0;  ///< centre in base
  double y_m = 0.0;
  double width_m = 0.0;
  double roc_laser = 0.0;
  double roc_colour = 0.0;
  double roc_vision = 0.0;
  std::optional<vision::WindowLight> light;  ///< mean colour of its window, without gains
};

/// Adapts the models of width, colour and brightness to the trees while driving.
///
/// Each sensor updates only the other sensor's model: trees confirmed by the camera update the
/// width, trees confirmed by the laser the colour. A post of trunk width misleads the laser, so the
/// colour must also be close to the present colour model. Each object counts once, however long it
/// is observed; the target is a trimmed mean over objects; steps are limited per second of message
/// time and in total. Too few trees, disagreeing sensors or two populations freeze a model. If the
/// confirmed fraction collapses, the model returns to its last good state, and if that does not
/// help, to the calibration. The result depends only on the observations and their order.
class Adaptation {
 public:
  Adaptation(const AdaptationConfig& config, double width_mean_m);

  /// Adds the observations of one scan, in order of time. Returns the steps of the model.
  std::vector<AdaptationStep> add(std::int64_t utime,
                                  const std::vector<AdaptationObservation>& observations);

  /// The model to use for the next scan.
  const AdaptedModel& model() const { return model_; }

 private:
  /// Running mean of one quantity of an object, with a minimum weight of the newest observation.
  struct RunningMean {
    double value = 0.0;
    int num_observations = 0;
    void add(double observation);
  };
  /// One object, tracked from scan to scan.
  struct TrackedObject {
    std::int64_t last_utime = 0;
    double x_m = 0.0;  ///< in base, when last seen
    double y_m = 0.0;
    int num_observations = 0;
    int num_by_laser = 0;   ///< observations confirmed by the laser
    int num_confirmed = 0;  ///< observations confirmed by laser and camera
    RunningMean width_m;
    RunningMean blue, red, green;             ///< relative to the reference
    RunningMean blue_residual, red_residual;  ///< relative to the model at that time
    RunningMean raw_blue, raw_red, raw_green;
  };
  /// Values of the newest objects, from which the model is updated.
  struct Evidence {
    std::vector<double> widths_m;
    std::vector<double> blue, red, green, blue_residual, red_residual;
    int num_by_laser = 0;
    double confident_share = 0.0;
  };

  void track_observation(std::int64_t utime, const AdaptationObservation& observation);
  void update_object(TrackedObject& object, const AdaptationObservation& observation) const;
  void find_reference();
  Evidence gather() const;
  void adapt_models(double dt_s, std::vector<AdaptationStep>& steps);
  bool roll_back(const Evidence& evidence, std::vector<AdaptationStep>& steps);
  AdaptationReason width_freeze_reason(const Evidence& evidence) const;
  AdaptationReason light_freeze_reason(const Evidence& evidence) const;
  AdaptationStep step_of(AdaptationAction action, AdaptationReason reason,
                         const Evidence& evidence);

  AdaptationConfig config_;
  AdaptedModel calibrated_;
  AdaptedModel model_;
  AdaptedModel last_good_;
  double good_fraction_ = 0.0;  ///< confirmed fraction of the last good state
  AdaptationReason frozen_ = AdaptationReason::kNone;
  std::optional<vision::WindowLight> reference_;
  std::deque<TrackedObject> objects_;  ///< in order of the first observation
  std::int64_t last_utime_ = INT64_MIN;
  std::int64_t considered_utime_ = INT64_MIN;
  std::int32_t next_seq_ = 0;
};

/// Gains that correct an image from the present light to that of the calibration.
vision::ChannelGains light_correction_gains(const Light& light);

}  // namespace orchard::detection
