// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunk_model.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "calibration/hue_interval.hpp"

namespace orchard::calibration {
namespace {

/// Without poses a thing is followed from look to look, for this long at most.
constexpr std::int64_t kLostAfter_us = 1'000'000;
/// A look beyond this many robust standard deviations is a mistake of segmentation, not scatter.
constexpr double kOutlier = 3.5;
constexpr double kMadToSd = 1.4826;

struct Thing {
  ThingSeen seen;
  std::int64_t last_utime = 0;
  bool in_map = false;
  std::vector<std::size_t> looks;
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

double hue_distance_deg(double a_deg, double b_deg) {
  return std::abs(std::remainder(a_deg - b_deg, 360.0));
}

std::vector<Thing> follow_things(const std::vector<TrunkObservation>& looks,
                                 const TrunkModelOptions& options) {
  std::vector<Thing> things;
  for (std::size_t i = 0; i < looks.size(); ++i) {
    const TrunkObservation& look = looks[i];
    Thing* nearest = nullptr;
    double nearest_m = options.gate_m;
    for (Thing& thing : things) {
      if (thing.seen.log != look.log || thing.in_map != look.in_map) continue;
      if (thing.last_utime == look.utime) continue;  // one look per scan
      if (!look.in_map && look.utime - thing.last_utime > kLostAfter_us) continue;
      const double distance_m = std::hypot(thing.seen.x_m - look.x_m, thing.seen.y_m - look.y_m);
      if (distance_m < nearest_m) {
        nearest_m = distance_m;
        nearest = &thing;
      }
    }
    if (!nearest) {
      things.emplace_back();
      nearest = &things.back();
      nearest->seen.log = look.log;
      nearest->in_map = look.in_map;
    }
    nearest->looks.push_back(i);
    nearest->last_utime = look.utime;
    const double share = look.in_map ? 1.0 / static_cast<double>(nearest->looks.size()) : 1.0;
    nearest->seen.x_m += share * (look.x_m - nearest->seen.x_m);
    nearest->seen.y_m += share * (look.y_m - nearest->seen.y_m);
  }
  for (Thing& thing : things) {
    std::vector<double> widths_m;
    vision::HueHistogram hues;
    for (const std::size_t i : thing.looks) {
      widths_m.push_back(looks[i].width_m);
      add(looks[i].hues, hues);
    }
    thing.seen.num_observations = static_cast<int>(thing.looks.size());
    thing.seen.median_width_m = median(std::move(widths_m));
    thing.seen.dominant_hue_deg = vision::dominant_hue_deg(hues, options.hue_bins);
  }
  return things;
}

bool alike(const ThingSeen& a, const ThingSeen& typical, bool has_hue,
           const TrunkModelOptions& options) {
  return std::abs(a.median_width_m - typical.median_width_m) <=
             options.width_spread * typical.median_width_m &&
         (!has_hue ||
          hue_distance_deg(a.dominant_hue_deg, typical.dominant_hue_deg) <= options.hue_spread_deg);
}

/// Marks the largest group of things alike; among equals the one looked at most often.
void mark_trunks(std::vector<Thing>& things, bool has_hue, const TrunkModelOptions& options) {
  const auto counts = [&options](const Thing& t) {
    return t.seen.num_observations >= options.min_observations;
  };
  const Thing* typical = nullptr;
  int most_things = 0, most_looks = 0;
  for (const Thing& candidate : things) {
    if (!counts(candidate)) continue;
    int num_things = 0, num_looks = 0;
    for (const Thing& other : things) {
      if (!counts(other) || !alike(other.seen, candidate.seen, has_hue, options)) continue;
      ++num_things;
      num_looks += other.seen.num_observations;
    }
    if (num_things > most_things || (num_things == most_things && num_looks > most_looks)) {
      most_things = num_things;
      most_looks = num_looks;
      typical = &candidate;
    }
  }
  if (!typical) {
    throw std::runtime_error("nothing that stands alone was seen " +
                             std::to_string(options.min_observations) +
                             " times or more, so there is nothing to learn trunks from");
  }
  const ThingSeen reference = typical->seen;
  for (Thing& thing : things) {
    thing.seen.is_trunk = counts(thing) && alike(thing.seen, reference, has_hue, options);
  }
}

void measure_width(const std::vector<TrunkObservation>& looks, std::vector<std::size_t>& used,
                   TrunkModel& model) {
  std::vector<double> widths_m, deviations_m;
  for (const std::size_t i : used) widths_m.push_back(looks[i].width_m);
  const double middle_m = median(widths_m);
  for (const double width_m : widths_m) deviations_m.push_back(std::abs(width_m - middle_m));
  const double limit_m = std::max(kOutlier * kMadToSd * median(deviations_m), 0.05 * middle_m);
  used.erase(std::remove_if(
                 used.begin(), used.end(),
                 [&](std::size_t i) { return std::abs(looks[i].width_m - middle_m) > limit_m; }),
             used.end());
  const auto n = static_cast<double>(used.size());
  double sum_m = 0.0, squares_m2 = 0.0;
  for (const std::size_t i : used) sum_m += looks[i].width_m;
  model.width_mean_m = sum_m / n;
  for (const std::size_t i : used) {
    const double deviation_m = looks[i].width_m - model.width_mean_m;
    squares_m2 += deviation_m * deviation_m;
  }
  model.width_sd_m = n > 1.0 ? std::sqrt(squares_m2 / (n - 1.0)) : 0.0;
}

}  // namespace

TrunkModel estimate_trunk_model(const std::vector<TrunkObservation>& looks,
                                const TrunkModelOptions& options) {
  TrunkModel model;
  model.has_hue = std::any_of(looks.begin(), looks.end(), [](const TrunkObservation& look) {
    return look.hues.num_coloured > 0;
  });
  std::vector<Thing> things = follow_things(looks, options);
  mark_trunks(things, model.has_hue, options);

  std::vector<std::size_t> used;
  for (const Thing& thing : things) {
    model.things.push_back(thing.seen);
    if (!thing.seen.is_trunk) continue;
    ++model.num_trunks;
    used.insert(used.end(), thing.looks.begin(), thing.looks.end());
  }
  measure_width(looks, used, model);
  model.num_observations = static_cast<int>(used.size());
  if (model.has_hue) {
    vision::HueHistogram hues;
    for (const std::size_t i : used) add(looks[i].hues, hues);
    const HueInterval interval = hue_interval(hues, options.hue_tail, options.hue_margin_deg);
    model.hue_min_deg = interval.min_deg;
    model.hue_max_deg = interval.max_deg;
    if (interval.width_deg > 90.0) {
      model.warnings.push_back("the trunks' hues spread over " +
                               std::to_string(static_cast<int>(interval.width_deg)) +
                               " degrees, so that colour will tell little");
    }
  }
  if (model.num_trunks < options.wanted_trunks) {
    model.warnings.push_back("only " + std::to_string(model.num_trunks) + " trunks were found; " +
                             std::to_string(options.wanted_trunks) +
                             " or more make a model that can be relied on");
  }
  return model;
}

}  // namespace orchard::calibration
