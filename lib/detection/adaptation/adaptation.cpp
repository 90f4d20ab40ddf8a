// SPDX-License-Identifier: BSD-3-Clause
#include "detection/adaptation/adaptation.hpp"

#include <algorithm>
#include <cmath>

#include "detection/adaptation/two_groups.hpp"
#include "timing/units.hpp"

namespace orchard::detection {
namespace {

/// Trees seen longer ago do not teach [s]: the light has changed since.
constexpr double kWindow_s = 40.0;

/// The newest trees teach, at most so many: enough for a mean, few enough to follow.
constexpr int kWindowTrees = 12;

/// Min roc_laser of a tree that updates the colour.
constexpr double kTeachingRocLaser = 0.3;

/// Min roc_vision of a tree that updates the width.
constexpr double kTeachingRocVision = 0.55;

/// Min roc_colour of a tree that updates the colour; excludes other objects of trunk width.
constexpr double kTeachingRocColour = 0.1;

/// Max distance of an observed colour from the present model (log of a channel's ratio to green).
constexpr double kColourGate = 0.3;

/// Min fraction of the laser's trunks that the camera must confirm; below it the models freeze.
constexpr double kAgreementMin = 0.2;

/// The models are rolled back when the confirmed fraction falls below this part of the good one.
constexpr double kCollapseFraction = 0.5;

/// Separation of two groups of trees, in pooled standard deviations, above which a model freezes.
constexpr double kSeparationMax_sd = 4.0;

/// Association gate between observations of an object in base; base moves between scans.
constexpr double kSameThing_m = 0.4;
constexpr std::int64_t kLostAfter_us = 600'000;
/// Min weight of the newest observation of an object, so that its mean follows a change of light.
constexpr double kNewestWeight = 0.1;
/// Objects are weighted by their number of observations up to this limit: objects seen once or
/// twice, such as parts of a bush, count less, and objects in view for long count no more than
/// trunks that are passed.
constexpr int kMaxObservations = 10;
/// A model is good while the confirmed fraction is at least this part of the good fraction.
constexpr double kStillGood = 0.9;
constexpr double kGoodFractionGain = 0.1;
/// Min fraction of the trees in a group; smaller groups are outliers.
constexpr double kPopulationFraction = 0.25;
/// Min difference of two populations: as a fraction of the width, and as a log of colour.
constexpr double kWidthApart = 0.1;
constexpr double kColourApart = 0.12;

/// Trimmed mean, without a fifth on either side. A median would jump between two kinds of bark.
double middle_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t cut = values.size() / 5;
  double sum = 0.0;
  for (std::size_t i = cut; i < values.size() - cut; ++i) sum += values[i];
  return sum / static_cast<double>(values.size() - 2 * cut);
}

/// Moves a value towards the trimmed mean of the trees' values by a fraction of the difference, at
/// most by `most`.
double moved(double value, const std::vector<double>& values, double fraction, double most) {
  const double way = middle_of(values) - value;
  return value + std::clamp(fraction * way, -most, most);
}

double bounded(double value, double centre, double limit) {
  return std::clamp(value, centre - limit, centre + limit);
}

bool two_populations(const std::vector<double>& values, double separation_max, double apart) {
  const auto groups = find_two_groups(values, kPopulationFraction, 0.0);
  return groups && groups->separation > separation_max &&
         groups->high_mean - groups->low_mean > apart;
}

bool same(const AdaptedModel& a, const AdaptedModel& b) {
  return a.width_mean_m == b.width_mean_m && a.light.blue == b.light.blue &&
         a.light.red == b.light.red && a.light.green == b.light.green;
}

}  // namespace

vision::ChannelGains light_correction_gains(const Light& light) {
  const double green = std::exp(-light.green);
  return {green * std::exp(-light.blue), green, green * std::exp(-light.red)};
}

void Adaptation::RunningMean::add(double observation) {
  ++num_observations;
  value += std::max(1.0 / num_observations, kNewestWeight) * (observation - value);
}

Adaptation::Adaptation(const AdaptationConfig& config, double width_mean_m) : config_(config) {
  calibrated_.width_mean_m = width_mean_m;
  model_ = last_good_ = calibrated_;
  if (config.reference_blue > 0.0 && config.reference_red > 0.0 && config.reference_green > 0.0) {
    reference_ =
        vision::WindowLight{std::log(config.reference_blue), std::log(config.reference_red),
                            std::log(config.reference_green)};
  }
}

std::vector<AdaptationStep> Adaptation::add(
    std::int64_t utime, const std::vector<AdaptationObservation>& observations) {
  std::vector<AdaptationStep> steps;
  if (utime <= last_utime_) return steps;  // ignore scans out of order
  last_utime_ = utime;
  for (const AdaptationObservation& observation : observations)
    track_observation(utime, observation);
  if (considered_utime_ == INT64_MIN) considered_utime_ = utime;
  const std::int64_t period_us = timing::microseconds(config_.period_s);
  const std::int64_t since_us = utime - considered_utime_;
  if (since_us < period_us) return steps;
  considered_utime_ = utime;
  const std::int64_t oldest = utime - timing::microseconds(kWindow_s);
  objects_.erase(
      std::remove_if(objects_.begin(), objects_.end(),
                     [&](const TrackedObject& object) { return object.last_utime < oldest; }),
      objects_.end());
  // A pause without scans gave no information, so it must not allow a larger step.
  adapt_models(1e-6 * static_cast<double>(std::min(since_us, 2 * period_us)), steps);
  return steps;
}

void Adaptation::track_observation(std::int64_t utime, const AdaptationObservation& observation) {
  TrackedObject* nearest = nullptr;
  double nearest_m = kSameThing_m;
  for (TrackedObject& object : objects_) {
    if (object.last_utime == utime || utime - object.last_utime > kLostAfter_us) continue;
    const double distance_m =
        std::hypot(object.x_m - observation.x_m, object.y_m - observation.y_m);
    if (distance_m < nearest_m) {
      nearest_m = distance_m;
      nearest = &object;
    }
  }
  if (!nearest) nearest = &objects_.emplace_back();
  nearest->last_utime = utime;
  nearest->x_m = observation.x_m;
  nearest->y_m = observation.y_m;
  update_object(*nearest, observation);
}

void Adaptation::update_object(TrackedObject& object,
                               const AdaptationObservation& observation) const {
  ++object.num_observations;
  const bool by_laser = observation.roc_laser >= kTeachingRocLaser;
  const bool by_camera = observation.roc_vision >= kTeachingRocVision;
  if (by_laser) ++object.num_by_laser;
  if (by_laser && by_camera) ++object.num_confirmed;
  if (by_camera) object.width_m.add(observation.width_m);
  if (!by_laser || !observation.light || observation.roc_colour < kTeachingRocColour) return;
  object.raw_blue.add(observation.light->blue);
  object.raw_red.add(observation.light->red);
  object.raw_green.add(observation.light->green);
  if (!reference_) return;
  const double blue = observation.light->blue - reference_->blue;
  const double red = observation.light->red - reference_->red;
  if (std::abs(blue - model_.light.blue) > kColourGate) return;
  if (std::abs(red - model_.light.red) > kColourGate) return;
  object.blue.add(blue);
  object.red.add(red);
  object.green.add(observation.light->green - reference_->green);
  object.blue_residual.add(blue - model_.light.blue);
  object.red_residual.add(red - model_.light.red);
}

/// Sets the reference colour if none was calibrated: that of the first trees of the drive.
void Adaptation::find_reference() {
  std::vector<double> blue, red, green;
  for (const TrackedObject& object : objects_) {
    if (object.raw_blue.num_observations == 0) continue;
    blue.push_back(object.raw_blue.value);
    red.push_back(object.raw_red.value);
    green.push_back(object.raw_green.value);
  }
  if (blue.size() < static_cast<std::size_t>(config_.min_trees)) return;
  reference_ = vision::WindowLight{middle_of(blue), middle_of(red), middle_of(green)};
}

Adaptation::Evidence Adaptation::gather() const {
  Evidence evidence;
  const auto enough = static_cast<std::size_t>(kWindowTrees);
  int num_judged = 0, num_confirmed = 0;
  for (auto object = objects_.rbegin(); object != objects_.rend(); ++object) {
    if (object->width_m.num_observations > 0 && evidence.widths_m.size() < enough) {
      evidence.widths_m.push_back(object->width_m.value);
    }
    if (object->blue.num_observations > 0 && evidence.blue.size() < enough) {
      evidence.blue.push_back(object->blue.value);
      evidence.red.push_back(object->red.value);
      evidence.green.push_back(object->green.value);
      evidence.blue_residual.push_back(object->blue_residual.value);
      evidence.red_residual.push_back(object->red_residual.value);
    }
    if (2 * object->num_by_laser < object->num_observations) continue;
    if (evidence.num_by_laser >= kWindowTrees) continue;
    ++evidence.num_by_laser;
    const int num_observations = std::min(object->num_by_laser, kMaxObservations);
    num_judged += num_observations;
    if (2 * object->num_confirmed >= object->num_by_laser) num_confirmed += num_observations;
  }
  if (evidence.num_by_laser > 0) {
    evidence.confident_share = static_cast<double>(num_confirmed) / num_judged;
  }
  return evidence;
}

AdaptationReason Adaptation::width_freeze_reason(const Evidence& evidence) const {
  if (evidence.widths_m.size() < static_cast<std::size_t>(config_.min_trees)) {
    return AdaptationReason::kTooFewTrees;
  }
  const bool two =
      two_populations(evidence.widths_m, kSeparationMax_sd, kWidthApart * calibrated_.width_mean_m);
  return two ? AdaptationReason::kTwoPopulations : AdaptationReason::kNone;
}

AdaptationReason Adaptation::light_freeze_reason(const Evidence& evidence) const {
  if (evidence.blue.size() < static_cast<std::size_t>(config_.min_trees)) {
    return AdaptationReason::kTooFewTrees;
  }
  const bool two = two_populations(evidence.blue_residual, kSeparationMax_sd, kColourApart) ||
                   two_populations(evidence.red_residual, kSeparationMax_sd, kColourApart);
  return two ? AdaptationReason::kTwoPopulations : AdaptationReason::kNone;
}

AdaptationStep Adaptation::step_of(AdaptationAction action, AdaptationReason reason,
                                   const Evidence& evidence) {
  AdaptationStep step;
  step.utime = considered_utime_;
  step.seq = next_seq_++;
  step.action = action;
  step.reason = reason;
  step.num_width_trees = static_cast<std::int32_t>(evidence.widths_m.size());
  step.num_colour_trees = static_cast<std::int32_t>(evidence.blue.size());
  step.confident_share = evidence.confident_share;
  step.model = model_;
  return step;
}

/// Updates the last good state, or rolls the model back if the confirmed fraction has collapsed.
/// Returns whether it has collapsed. After a rollback the objects observed with the rejected model
/// are dropped.
bool Adaptation::roll_back(const Evidence& evidence, std::vector<AdaptationStep>& steps) {
  const double fraction = evidence.confident_share;
  if (fraction >= kStillGood * good_fraction_) {
    good_fraction_ +=
        (good_fraction_ == 0.0 ? 1.0 : kGoodFractionGain) * (fraction - good_fraction_);
    last_good_ = model_;
    return false;
  }
  if (fraction >= kCollapseFraction * good_fraction_) return false;
  const bool has_moved = !same(model_, last_good_);
  if (!has_moved && same(model_, calibrated_)) return true;
  model_ = has_moved ? last_good_ : calibrated_;
  last_good_ = model_;
  const auto action = has_moved ? AdaptationAction::kRollback : AdaptationAction::kReset;
  steps.push_back(step_of(action, AdaptationReason::kConfidenceCollapsed, evidence));
  objects_.clear();
  return true;
}

void Adaptation::adapt_models(double dt_s, std::vector<AdaptationStep>& steps) {
  if (!reference_) find_reference();
  const Evidence evidence = gather();
  AdaptationReason width = AdaptationReason::kTooFewTrees, light = width;
  if (evidence.num_by_laser >= config_.min_trees) {
    if (roll_back(evidence, steps)) {
      width = light = AdaptationReason::kConfidenceCollapsed;
    } else if (evidence.confident_share < kAgreementMin) {
      width = light = AdaptationReason::kSensorsDisagree;
    } else {
      width = width_freeze_reason(evidence);
      light = light_freeze_reason(evidence);
    }
  }
  const AdaptationReason freeze_reason = std::max(width, light);
  if (freeze_reason != frozen_) {
    const auto action = freeze_reason == AdaptationReason::kNone ? AdaptationAction::kResume
                                                                 : AdaptationAction::kFreeze;
    frozen_ = freeze_reason;
    steps.push_back(step_of(action, freeze_reason, evidence));
  }
  const AdaptedModel before = model_;
  const double fraction = std::min(dt_s / config_.smoothing_s, 1.0);
  if (width == AdaptationReason::kNone) {
    const double mean_m = calibrated_.width_mean_m;
    model_.width_mean_m = bounded(moved(model_.width_mean_m, evidence.widths_m, fraction,
                                        config_.width_rate_per_s * dt_s * mean_m),
                                  mean_m, config_.width_limit * mean_m);
  }
  if (light == AdaptationReason::kNone) {
    Light& l = model_.light;
    const double most = config_.colour_rate_per_s * dt_s;
    l.blue = bounded(moved(l.blue, evidence.blue, fraction, most), 0.0, config_.colour_limit);
    l.red = bounded(moved(l.red, evidence.red, fraction, most), 0.0, config_.colour_limit);
    l.green =
        bounded(moved(l.green, evidence.green, fraction, config_.brightness_rate_per_s * dt_s), 0.0,
                config_.brightness_limit);
  }
  if (!same(model_, before)) {
    steps.push_back(step_of(AdaptationAction::kStep, AdaptationReason::kNone, evidence));
  }
}

}  // namespace orchard::detection
