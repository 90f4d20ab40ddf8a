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

/// What one scan and its picture say of one candidate: everything the models can learn from.
struct AdaptationObservation {
  double x_m = 0.0;  ///< of its centre in base
  double y_m = 0.0;
  double width_m = 0.0;
  double roc_laser = 0.0;
  double roc_colour = 0.0;
  double roc_vision = 0.0;
  std::optional<vision::WindowLight> light;  ///< of its colour window, as the camera gave it
};

/// Lets the models of width, colour and brightness follow the trees while driving.
///
/// What one sensor is sure of teaches the other's model, never its own: the camera's trees the
/// width, the laser's the colour. A post of trunk width fools the laser, so colour also asks for
/// nearness to the colour model as it is. Each thing counts once however long it is looked at;
/// the middle of all things leads; steps are bounded per second
/// of message time and in all. Few trees, sensors that disagree or two populations freeze a model;
/// when far less is confirmed than before it goes back to where it was last good, and if that does
/// not help, to the calibration. A function of the observations in their order only.
class Adaptation {
 public:
  Adaptation(const AdaptationConfig& config, double width_mean_m);

  /// Takes the observations of one scan, scans in order of time; gives what happened to the model.
  std::vector<AdaptationStep> add(std::int64_t utime,
                                  const std::vector<AdaptationObservation>& observations);

  /// What the next scan is to be judged with.
  const AdaptedModel& model() const { return model_; }

 private:
  /// A value that follows the observations of one thing.
  struct Follower {
    double value = 0.0;
    int num_observations = 0;
    void add(double observation);
  };
  /// One thing, followed from observation to observation.
  struct Thing {
    std::int64_t last_utime = 0;
    double x_m = 0.0;  ///< in base, when last seen
    double y_m = 0.0;
    int num_observations = 0;
    int num_by_laser = 0;   ///< observations with the laser sure
    int num_confirmed = 0;  ///< of them, with the camera sure
    Follower width_m;
    Follower blue, red, green;             ///< against the reference
    Follower blue_residual, red_residual;  ///< and against the model at that time
    Follower raw_blue, raw_red, raw_green;
  };
  /// What the newest things say.
  struct Evidence {
    std::vector<double> widths_m;
    std::vector<double> blue, red, green, blue_residual, red_residual;
    int num_by_laser = 0;
    double confident_share = 0.0;
  };

  void follow(std::int64_t utime, const AdaptationObservation& observation);
  void teach(Thing& thing, const AdaptationObservation& observation) const;
  void find_reference();
  Evidence gather() const;
  void consider(double dt_s, std::vector<AdaptationStep>& steps);
  bool go_back(const Evidence& evidence, std::vector<AdaptationStep>& steps);
  AdaptationReason width_obstacle(const Evidence& evidence) const;
  AdaptationReason light_obstacle(const Evidence& evidence) const;
  AdaptationStep step_of(AdaptationAction action, AdaptationReason reason,
                         const Evidence& evidence);

  AdaptationConfig config_;
  AdaptedModel calibrated_;
  AdaptedModel model_;
  AdaptedModel last_good_;
  double good_fraction_ = 0.0;  ///< confirmed where the model was last good
  AdaptationReason frozen_ = AdaptationReason::kNone;
  std::optional<vision::WindowLight> reference_;
  std::deque<Thing> things_;  ///< in order of first sight
  std::int64_t last_utime_ = INT64_MIN;
  std::int64_t considered_utime_ = INT64_MIN;
  std::int32_t next_seq_ = 0;
};

/// What undoes today's light, so that a picture looks as in the light of the calibration.
vision::ChannelGains undoing(const Light& light);

}  // namespace orchard::detection
