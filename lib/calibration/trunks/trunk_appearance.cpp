// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/trunk_appearance.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "geometry/statistics.hpp"
#include "vision/appearance.hpp"

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

/// The windows of the model's objects, and which of them lie on an object and which beside it.
struct TrunkWindows {
  std::vector<AppearanceSample> samples;
  std::vector<char> is_on;
  std::vector<const WindowObservation*> windows;
};

TrunkWindows windows_of(const std::vector<TrunkObservation>& observations,
                        const TrunkModel& model) {
  TrunkWindows all;
  const auto take = [&](const WindowObservation& window, bool is_trunk, bool is_on, int group) {
    all.samples.push_back({window.features, is_trunk, group});
    all.is_on.push_back(is_on);
    all.windows.push_back(&window);
  };
  for (std::size_t object = 0; object < model.objects.size(); ++object) {
    const ObservedObject& seen = model.objects[object];
    if (seen.is_doubtful) continue;
    for (const std::size_t i : spread(seen.observations)) {
      for (const auto& window : observations[i].on)
        take(window, seen.is_trunk, true, static_cast<int>(object));
      if (!seen.is_trunk) continue;
      for (const auto& window : observations[i].beside)
        take(window, false, false, static_cast<int>(object));
    }
  }
  return all;
}

}  // namespace

TrunkAppearance learn_trunk_appearance(const std::vector<TrunkObservation>& observations,
                                       const TrunkModel& model,
                                       const vision::ColourConfig& colour) {
  vision::ColourConfig interval = colour;
  interval.hue_min_deg = model.hue_min_deg;
  interval.hue_max_deg = model.hue_max_deg;
  const TrunkWindows all = windows_of(observations, model);
  std::vector<double> hue_trunk, hue_other;
  for (std::size_t i = 0; i < all.samples.size(); ++i) {
    const double roc = vision::colour_confidence(all.windows[i]->hues, interval).roc;
    (all.samples[i].is_trunk ? hue_trunk : hue_other).push_back(roc);
  }
  return {learn_appearance(all.samples), geometry::roc_area(hue_trunk, hue_other)};
}

std::vector<std::optional<double>> trunk_scores(const std::vector<TrunkObservation>& observations,
                                                const TrunkModel& model) {
  const TrunkWindows all = windows_of(observations, model);
  const AppearanceFit fit = learn_appearance(all.samples);
  std::vector<double> sums(model.objects.size()), numbers(model.objects.size());
  const auto add = [&](std::size_t object, double log_odds) {
    sums[object] += log_odds;
    numbers[object] += 1.0;
  };
  for (std::size_t i = 0; i < all.samples.size(); ++i) {
    if (!all.is_on[i]) continue;
    const auto object = static_cast<std::size_t>(all.samples[i].group);
    if (!std::isnan(fit.left_out[i])) add(object, fit.left_out[i]);
  }
  for (std::size_t object = 0; object < model.objects.size(); ++object) {
    if (!model.objects[object].is_doubtful) continue;
    for (const std::size_t i : spread(model.objects[object].observations)) {
      for (const WindowObservation& window : observations[i].on)
        add(object, vision::appearance_log_odds(window.features, fit.config));
    }
  }
  std::vector<std::optional<double>> scores(model.objects.size());
  for (std::size_t object = 0; object < scores.size(); ++object) {
    if (numbers[object] > 0.0) scores[object] = sums[object] / numbers[object];
  }
  return scores;
}

}  // namespace orchard::calibration
