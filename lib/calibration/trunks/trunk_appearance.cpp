// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/trunk_appearance.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include "geometry/statistics.hpp"
#include "vision/appearance/appearance.hpp"

namespace orchard::calibration {
namespace {

constexpr std::size_t kMaxObservations = 12;  // per object

/// Selects at most kMaxObservations of an object's observations, evenly spread.
std::vector<std::size_t> spread(const std::vector<std::size_t>& observations) {
  if (observations.size() <= kMaxObservations) return observations;
  std::vector<std::size_t> some;
  for (std::size_t i = 0; i < kMaxObservations; ++i)
    some.push_back(observations[i * observations.size() / kMaxObservations]);
  return some;
}

/// Confidence below which a window is not a trunk in any light.
constexpr double kSurelyNone = 0.1;

/// Widths of trees reach farther than the trunks that were chosen within width_spread: objects
/// within so many standard deviations of the chosen trunks may be trunks, too.
constexpr double kDoubtful_sigma = 3.0;

/// Largest difference from the mean width with which an object may be a trunk [m].
double doubtful_width_m(const TrunkModel& model) {
  double squares_m2 = 0.0;
  for (const ObservedObject& seen : model.objects) {
    if (seen.is_trunk) squares_m2 += geometry::square(seen.median_width_m - model.width_mean_m);
  }
  return std::max(model.width_spread * model.width_mean_m,
                  kDoubtful_sigma * std::sqrt(squares_m2 / std::max(1, model.num_trunks)));
}

/// Somebody who walks is observed at positions that scatter more than those of the trunks by at
/// least this factor.
constexpr double kWalks = 3.0;

/// RMS distance of an object's observations from their mean [m].
double scatter_m(const ObservedObject& seen, const std::vector<TrunkObservation>& observations) {
  double x_m = 0.0, y_m = 0.0, squares_m2 = 0.0;
  const auto n = static_cast<double>(std::max<std::size_t>(1, seen.observations.size()));
  for (const std::size_t i : seen.observations) {
    x_m += observations[i].x_m / n;
    y_m += observations[i].y_m / n;
  }
  for (const std::size_t i : seen.observations) {
    squares_m2 += geometry::square(observations[i].x_m - x_m);
    squares_m2 += geometry::square(observations[i].y_m - y_m);
  }
  return std::sqrt(squares_m2 / n);
}

/// Scatter from which on an object walks [m].
double walks_from_m(const TrunkModel& model, const std::vector<TrunkObservation>& observations) {
  std::vector<double> of_trunks_m;
  for (const ObservedObject& seen : model.objects) {
    if (seen.is_trunk) of_trunks_m.push_back(scatter_m(seen, observations));
  }
  return of_trunks_m.empty() ? 0.0 : kWalks * geometry::median(std::move(of_trunks_m));
}

bool may_be_trunk(const ObservedObject& seen, const TrunkModel& model, double limit_m) {
  return !seen.is_trunk && !model.is_picked &&
         std::abs(seen.median_width_m - model.width_mean_m) <= limit_m;
}

std::optional<double> mean_confidence(const ObservedObject& seen,
                                      const std::vector<TrunkObservation>& observations,
                                      const vision::AppearanceConfig& config) {
  double sum = 0.0, n = 0.0;
  for (const std::size_t i : spread(seen.observations)) {
    for (const WindowObservation& window : observations[i].on) {
      sum += vision::appearance_confidence(window.features, config);
      n += 1.0;
    }
  }
  if (n <= 0.0) return std::nullopt;
  return sum / n;
}

}  // namespace

TrunkAppearance learn_trunk_appearance(const std::vector<TrunkObservation>& observations,
                                       const TrunkModel& model,
                                       const vision::ColourConfig& colour) {
  vision::ColourConfig interval = colour;
  interval.hue_min_deg = model.hue_min_deg;
  interval.hue_max_deg = model.hue_max_deg;
  std::vector<AppearanceSample> samples;
  std::vector<double> hue_trunk, hue_other;
  const auto take = [&](const WindowObservation& window, bool is_trunk, int group) {
    samples.push_back({window.features, is_trunk, group});
    const double roc = vision::colour_confidence(window.hues, interval).roc;
    (is_trunk ? hue_trunk : hue_other).push_back(roc);
  };
  const double limit_m = doubtful_width_m(model), walks_m = walks_from_m(model, observations);
  std::vector<std::size_t> doubtful;
  for (std::size_t object = 0; object < model.objects.size(); ++object) {
    const ObservedObject& seen = model.objects[object];
    if (may_be_trunk(seen, model, limit_m) && scatter_m(seen, observations) < walks_m) {
      doubtful.push_back(object);
      continue;
    }
    for (const std::size_t i : spread(seen.observations)) {
      for (const auto& window : observations[i].on)
        take(window, seen.is_trunk, static_cast<int>(object));
      if (!seen.is_trunk) continue;
      for (const auto& window : observations[i].beside)
        take(window, false, static_cast<int>(object));
    }
  }
  TrunkAppearance appearance;
  const AppearanceFit first = learn_appearance(samples);
  const std::size_t num_sure = samples.size();
  for (const std::size_t object : doubtful) {
    const ObservedObject& seen = model.objects[object];
    const auto confidence = mean_confidence(seen, observations, first.config);
    if (!confidence) continue;
    const double off_m = std::abs(seen.median_width_m - model.width_mean_m);
    if (*confidence >= first.config.confidence_min &&
        off_m <= model.width_spread * model.width_mean_m) {
      appearance.likely_trunks.push_back(static_cast<int>(object) + 1);
    }
    if (*confidence > kSurelyNone) continue;
    for (const std::size_t i : spread(seen.observations)) {
      for (const auto& window : observations[i].on) take(window, false, static_cast<int>(object));
    }
  }
  appearance.fit = samples.size() > num_sure ? learn_appearance(samples) : first;
  appearance.hue_interval_area = geometry::roc_area(hue_trunk, hue_other);
  return appearance;
}

TrunkModel with_likely_trunks(const std::vector<TrunkObservation>& observations,
                              const TrunkModel& model, TrunkModelOptions options,
                              const vision::ColourConfig& colour) {
  if (model.is_picked || !model.has_hue) return model;
  TrunkModel all = model;
  try {
    while (true) {  // each round adds at least one object
      const auto likely = learn_trunk_appearance(observations, all, colour).likely_trunks;
      options.added.insert(options.added.end(), likely.begin(), likely.end());
      TrunkModel more = estimate_trunk_model(observations, options);
      if (more.num_trunks <= all.num_trunks) return all;
      all = std::move(more);
    }
  } catch (const std::runtime_error&) {
    return all;
  }
}

std::optional<vision::WindowLight> trunk_light(const std::vector<TrunkObservation>& observations,
                                               const TrunkModel& model) {
  std::vector<double> blue, red, green;
  for (const ObservedObject& seen : model.objects) {
    std::vector<double> of_object[3];
    for (const std::size_t i : seen.observations) {
      if (!seen.is_trunk || !observations[i].light) continue;
      of_object[0].push_back(observations[i].light->blue);
      of_object[1].push_back(observations[i].light->red);
      of_object[2].push_back(observations[i].light->green);
    }
    if (of_object[0].empty()) continue;
    blue.push_back(geometry::median(std::move(of_object[0])));
    red.push_back(geometry::median(std::move(of_object[1])));
    green.push_back(geometry::median(std::move(of_object[2])));
  }
  if (blue.empty()) return std::nullopt;
  return vision::WindowLight{geometry::median(std::move(blue)), geometry::median(std::move(red)),
                             geometry::median(std::move(green))};
}

}  // namespace orchard::calibration
