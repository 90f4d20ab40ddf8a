// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/trunk_model.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "calibration/tuning.hpp"
#include "geometry/statistics.hpp"

namespace orchard::calibration {
namespace {

// derived: half a circle of hues, radians for a degree.
constexpr int kHalfTurn = vision::kNumHues / 2;
constexpr double kRadPerDeg = 3.14159265358979323846 / 180.0;

double wrap_hue_deg(double hue_deg) { return hue_deg - 360.0 * std::floor(hue_deg / 360.0); }

/// Index of the hue nearest to the circular mean.
int mean_hue(const vision::HueHistogram& hues) {
  double c = 0.0, s = 0.0;
  for (int hue = 0; hue < vision::kNumHues; ++hue) {
    const double angle_rad = hue * vision::kHueStep_deg * kRadPerDeg;
    c += hues.counts[static_cast<std::size_t>(hue)] * std::cos(angle_rad);
    s += hues.counts[static_cast<std::size_t>(hue)] * std::sin(angle_rad);
  }
  const double mean_deg = wrap_hue_deg(std::atan2(s, c) / kRadPerDeg);
  return static_cast<int>(std::lround(mean_deg / vision::kHueStep_deg)) % vision::kNumHues;
}

}  // namespace

void add(const vision::HueHistogram& hues, vision::HueHistogram& sum) {
  for (std::size_t hue = 0; hue < hues.counts.size(); ++hue) sum.counts[hue] += hues.counts[hue];
  sum.num_coloured += hues.num_coloured;
  sum.num_pixels += hues.num_pixels;
}

HueInterval hue_interval(const vision::HueHistogram& hues, double tail, double margin_deg) {
  if (hues.num_coloured <= 0)
    throw std::invalid_argument("no coloured pixels, so the hue is unknown");
  const int mean = mean_hue(hues);
  const auto count_at = [&](int offset) {
    const int hue = (mean + offset + 2 * vision::kNumHues) % vision::kNumHues;
    return hues.counts[static_cast<std::size_t>(hue)];
  };
  const double allowed = tail * hues.num_coloured;
  int low = -kHalfTurn, high = kHalfTurn - 1;
  for (double left_out = count_at(low); left_out <= allowed && low < high;) {
    left_out += count_at(++low);
  }
  for (double left_out = count_at(high); left_out <= allowed && high > low;) {
    left_out += count_at(--high);
  }
  HueInterval interval;
  interval.width_deg = (high - low) * vision::kHueStep_deg + 2.0 * margin_deg;
  if (interval.width_deg >= 360.0) return {0.0, 360.0, 360.0};
  interval.min_deg = wrap_hue_deg((mean + low) * vision::kHueStep_deg - margin_deg);
  interval.max_deg = wrap_hue_deg((mean + high) * vision::kHueStep_deg + margin_deg);
  return interval;
}

namespace {

/// Max time between two associated observations of an object
/// without poses.
constexpr std::int64_t kLostAfter_us = 1'000'000;
// derived: 1 of 2000 normal deviations is larger.
/// Observations beyond this many robust standard deviations are segmentation errors, not scatter.
constexpr double kOutlier = 3.5;

struct ObjectTrack {
  ObservedObject seen;
  std::int64_t last_utime = 0;
  bool in_map = false;
  bool is_separate = true;  ///< nothing else was observed beside it
  std::optional<vision::WindowLight> colour;
};

double hue_distance_deg(double a_deg, double b_deg) {
  return std::abs(std::remainder(a_deg - b_deg, 360.0));
}

std::vector<ObjectTrack> track_objects(const std::vector<TrunkObservation>& observations,
                                       const TrunkModelOptions& options) {
  std::vector<ObjectTrack> tracks;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const TrunkObservation& observation = observations[i];
    ObjectTrack* nearest = nullptr;
    double nearest_m = options.gate_m;
    for (ObjectTrack& track : tracks) {
      if (track.seen.log != observation.log || track.in_map != observation.in_map) continue;
      if (track.last_utime == observation.utime) continue;  // one observation per scan
      if (!observation.in_map && observation.utime - track.last_utime > kLostAfter_us) continue;
      const double distance_m =
          std::hypot(track.seen.x_m - observation.x_m, track.seen.y_m - observation.y_m);
      if (distance_m < nearest_m) {
        nearest_m = distance_m;
        nearest = &track;
      }
    }
    if (!nearest) {
      tracks.emplace_back();
      nearest = &tracks.back();
      nearest->seen.log = observation.log;
      nearest->in_map = observation.in_map;
    }
    nearest->seen.observations.push_back(i);
    nearest->last_utime = observation.utime;
    const double fraction =
        observation.in_map ? 1.0 / static_cast<double>(nearest->seen.observations.size()) : 1.0;
    nearest->seen.x_m += fraction * (observation.x_m - nearest->seen.x_m);
    nearest->seen.y_m += fraction * (observation.y_m - nearest->seen.y_m);
  }
  for (ObjectTrack& track : tracks) {
    std::vector<double> widths_m, blue, red;
    vision::HueHistogram hues;
    for (const std::size_t i : track.seen.observations) {
      widths_m.push_back(observations[i].width_m);
      add(observations[i].hues, hues);
      if (!observations[i].light) continue;
      blue.push_back(observations[i].light->blue);
      red.push_back(observations[i].light->red);
    }
    if (!blue.empty()) {
      track.colour = vision::WindowLight{geometry::midpoint_median(std::move(blue)),
                                         geometry::midpoint_median(std::move(red)), 0.0};
    }
    track.seen.num_observations = static_cast<int>(track.seen.observations.size());
    track.seen.median_width_m = geometry::midpoint_median(std::move(widths_m));
    track.seen.dominant_hue_deg = vision::dominant_hue_deg(hues, vision::ColourConfig::kHueBins);
  }
  return tracks;
}

/// Finds the tracks that have others beside them: parts of one bush are detected as several tracks.
void find_neighbours(std::vector<ObjectTrack>& tracks, const TrunkModelOptions& options) {
  for (ObjectTrack& track : tracks) {
    if (!track.in_map) continue;
    track.is_separate = std::none_of(tracks.begin(), tracks.end(), [&](const ObjectTrack& other) {
      if (&other == &track || other.seen.log != track.seen.log || !other.in_map) return false;
      if (other.seen.num_observations < options.min_observations) return false;
      const double apart_m =
          std::hypot(other.seen.x_m - track.seen.x_m, other.seen.y_m - track.seen.y_m);
      return apart_m <
             options.gate_m + 0.5 * (other.seen.median_width_m + track.seen.median_width_m);
    });
  }
}

bool same_colour(const ObjectTrack& a, const ObjectTrack& typical,
                 const TrunkModelOptions& options) {
  if (a.colour && typical.colour) {
    return std::hypot(a.colour->blue - typical.colour->blue, a.colour->red - typical.colour->red) <=
           tuning::kSameColour;
  }
  return hue_distance_deg(a.seen.dominant_hue_deg, typical.seen.dominant_hue_deg) <=
         options.hue_spread_deg;
}

bool alike(const ObjectTrack& a, const ObjectTrack& typical, bool has_hue,
           const TrunkModelOptions& options) {
  return std::abs(a.seen.median_width_m - typical.seen.median_width_m) <=
             options.width_spread * typical.seen.median_width_m &&
         (!has_hue || same_colour(a, typical, options));
}

/// Number of observations of the object that the middle one of all these observations belongs to.
int typical_observations(const std::vector<ObjectTrack>& tracks,
                         const std::vector<std::size_t>& group) {
  std::vector<int> each;
  for (const std::size_t i : group) {
    const int n = tracks[i].seen.num_observations;
    each.insert(each.end(), static_cast<std::size_t>(n), n);
  }
  const auto middle = each.begin() + static_cast<std::ptrdiff_t>(each.size() / 2);
  std::nth_element(each.begin(), middle, each.end());
  return each.empty() ? 0 : *middle;
}

/// The group of similar objects that are not `taken` with the most observations, those of the same
/// width counting most: the mode of the widths. Empty if no object has enough observations.
std::vector<std::size_t> largest_population(const std::vector<ObjectTrack>& tracks,
                                            const std::vector<bool>& taken, bool has_hue,
                                            const TrunkModelOptions& options) {
  const auto counts = [&](std::size_t i) {
    return !taken[i] && tracks[i].is_separate &&
           tracks[i].seen.num_observations >= options.min_observations;
  };
  std::vector<std::size_t> best;
  double best_sum = 0.0;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (!counts(i)) continue;
    const double width_m = tracks[i].seen.median_width_m;
    std::vector<std::size_t> group;
    double sum = 0.0;
    for (std::size_t k = 0; k < tracks.size(); ++k) {
      if (!counts(k) || !alike(tracks[k], tracks[i], has_hue, options)) continue;
      group.push_back(k);
      const double off = std::abs(tracks[k].seen.median_width_m - width_m) /
                         std::max(1e-6, options.width_spread * width_m);
      sum += tracks[k].seen.num_observations * (1.0 - off);
    }
    if (sum > best_sum) {
      best = std::move(group);
      best_sum = sum;
    }
  }
  const double fewest = tuning::kLookedAtMin * typical_observations(tracks, best);
  best.erase(std::remove_if(best.begin(), best.end(),
                            [&](std::size_t i) {
                              return tracks[i].in_map && tracks[i].seen.num_observations < fewest;
                            }),
             best.end());
  return best;
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double variance_of(const std::vector<double>& values) {
  const double mean = mean_of(values);
  double squares = 0.0;
  for (const double value : values) squares += geometry::square(value - mean);
  return values.size() > 1 ? squares / (static_cast<double>(values.size()) - 1.0) : 0.0;
}

/// Separation of two populations in pooled standard deviations.
double separation(const std::vector<double>& a, const std::vector<double>& b, double sd_floor) {
  const double pooled = std::sqrt(0.5 * (variance_of(a) + variance_of(b)));
  return std::abs(mean_of(a) - mean_of(b)) / std::max(pooled, sd_floor);
}

/// Warns when the second largest population is not separated from the trunks, or may be the trunks.
void compare_populations(const std::vector<ObjectTrack>& tracks,
                         const std::vector<std::size_t>& trunks, bool has_hue,
                         const TrunkModelOptions& options, TrunkModel& model) {
  std::vector<bool> taken(tracks.size());
  for (const std::size_t i : trunks) taken[i] = true;
  const auto others = largest_population(tracks, taken, has_hue, options);
  if (others.size() < 2 || trunks.size() < 2) return;
  std::vector<double> widths_m[2], hues_deg[2];
  const double hue_deg = tracks[trunks.front()].seen.dominant_hue_deg;
  for (const int which : {0, 1}) {
    for (const std::size_t i : which == 0 ? trunks : others) {
      widths_m[which].push_back(tracks[i].seen.median_width_m);
      hues_deg[which].push_back(std::remainder(tracks[i].seen.dominant_hue_deg - hue_deg, 360.0));
    }
  }
  const double by_width = separation(widths_m[0], widths_m[1], 1e-3);
  const double by_hue = has_hue ? separation(hues_deg[0], hues_deg[1], 1.0) : 0.0;
  std::string what = fmt::format("{} other objects of about {:.0f} mm", others.size(),
                                 1e3 * geometry::midpoint_median(widths_m[1]));
  std::string apart = fmt::format("{:.1f} sd in width", by_width);
  if (has_hue) {
    what += fmt::format(" and hue {:.0f}", geometry::midpoint_median(hues_deg[1]) + hue_deg);
    apart += fmt::format(", {:.1f} sd in hue", by_hue);
  }
  if (std::max(by_width, by_hue) < options.separation_min) {
    model.warnings.push_back(fmt::format(
        "{} cannot be separated from the trunks ({}; {:.0f} are needed): a mixed orchard, or posts "
        "like trunks; choose the trunks with --map and --ids",
        what, apart, options.separation_min));
  }
  const double fraction =
      static_cast<double>(trunks.size()) / static_cast<double>(trunks.size() + others.size());
  if (fraction < options.fraction_min) {
    model.warnings.push_back(
        fmt::format("{} are about as many as the {} objects classified as trunks; choose the "
                    "trunks with --map and --ids",
                    what, trunks.size()));
  }
}

/// Warns when the trunks themselves form two groups: the split with the largest separation D of
/// the means (Ashman, Bird and Zepf 1994), each of a fifth of them at least. A single population
/// split in the middle has D = 2.6 if normal and 3.5 if uniform.
void warn_of_two_populations(const std::vector<ObjectTrack>& tracks,
                             const std::vector<std::size_t>& trunks,
                             const TrunkModelOptions& options, TrunkModel& model) {
  std::vector<double> widths_m;
  for (const std::size_t i : trunks) widths_m.push_back(tracks[i].seen.median_width_m);
  if (widths_m.size() < 8) return;
  std::sort(widths_m.begin(), widths_m.end());
  const double sd_floor = 0.01 * geometry::midpoint_median(widths_m);
  const auto least = static_cast<std::ptrdiff_t>((widths_m.size() + 4) / 5);
  double largest = 0.0;
  std::vector<double> thin_m, thick_m;
  for (auto cut = widths_m.begin() + least; cut <= widths_m.end() - least; ++cut) {
    const std::vector<double> low_m(widths_m.begin(), cut), high_m(cut, widths_m.end());
    const double apart = separation(low_m, high_m, sd_floor);
    if (apart <= largest) continue;
    largest = apart;
    thin_m = low_m;
    thick_m = high_m;
  }
  if (largest < options.separation_min) return;
  model.warnings.push_back(fmt::format(
      "there are two kinds of trunks, about {:.0f} mm and {:.0f} mm wide ({:.1f} sd apart): one "
      "mean fits neither; choose the trunks of one kind with --map and --ids",
      1e3 * mean_of(thin_m), 1e3 * mean_of(thick_m), largest));
}

std::vector<std::size_t> picked_by_place(const std::vector<ObjectTrack>& tracks,
                                         const std::vector<PickedTrunk>& places, double gate_m) {
  std::vector<std::size_t> picked;
  std::string unseen;
  for (const PickedTrunk& place : places) {
    const auto before = picked.size();
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      const ObservedObject& seen = tracks[i].seen;
      if (!tracks[i].in_map || std::hypot(seen.x_m - place.x_m, seen.y_m - place.y_m) > gate_m) {
        continue;
      }
      if (std::find(picked.begin(), picked.end(), i) == picked.end()) picked.push_back(i);
    }
    if (picked.size() == before) {
      unseen += fmt::format("{}{} at ({:.2f}, {:.2f}) m", unseen.empty() ? "landmark " : ", ",
                            place.id, place.x_m, place.y_m);
    }
  }
  if (!unseen.empty()) {
    throw std::runtime_error("no complete observation of these landmarks of the map: " + unseen +
                             "; remove them from --ids");
  }
  return picked;
}

std::vector<std::size_t> find_trunks(const std::vector<ObjectTrack>& tracks, bool has_hue,
                                     const TrunkModelOptions& options) {
  if (!options.picked_trunks.empty()) {
    return picked_by_place(tracks, options.picked_trunks, options.gate_m);
  }
  if (!options.judged.empty()) return options.judged;
  const auto trunks =
      largest_population(tracks, std::vector<bool>(tracks.size()), has_hue, options);
  if (trunks.empty()) {
    throw std::runtime_error(fmt::format(
        "no separate object was observed {} times or more; drive past trunks more slowly or nearer",
        options.min_observations));
  }
  return trunks;
}

/// Estimates the growth of widths by the spot and subtracts it from the widths of all observations.
/// Empty if the growth is not significant.
std::vector<double> widths_without_spot(const std::vector<TrunkObservation>& observations,
                                        const TrunkModelOptions& options, TrunkModel& model) {
  std::vector<SpotWidth> of_trunks;
  for (std::size_t track = 0; track < model.objects.size(); ++track) {
    if (!model.objects[track].is_trunk) continue;
    for (const std::size_t i : model.objects[track].observations) {
      of_trunks.push_back({static_cast<int>(track), observations[i].range_m,
                           observations[i].beam_step_rad, observations[i].width_m});
    }
  }
  model.spot = fit_spot_divergence(of_trunks, options.min_beams);
  const double growth = model.spot && model.spot->significant() ? model.spot->divergence_rad : 0.0;
  std::vector<double> all_m;
  for (const TrunkObservation& observation : observations)
    all_m.push_back(observation.width_m - growth * observation.range_m);
  return all_m;
}

void measure_width(const std::vector<double>& all_m, std::vector<std::size_t>& used,
                   TrunkModel& model) {
  std::vector<double> widths_m, deviations_m;
  for (const std::size_t i : used) widths_m.push_back(all_m[i]);
  const double middle_m = geometry::midpoint_median(widths_m);
  for (const double width_m : widths_m) deviations_m.push_back(std::abs(width_m - middle_m));
  const double limit_m = std::max(
      kOutlier * geometry::kMadToSd * geometry::midpoint_median(deviations_m), 0.05 * middle_m);
  used.erase(std::remove_if(used.begin(), used.end(),
                            [&](std::size_t i) { return std::abs(all_m[i] - middle_m) > limit_m; }),
             used.end());
  widths_m.clear();
  for (const std::size_t i : used) widths_m.push_back(all_m[i]);
  model.width_mean_m = mean_of(widths_m);
  model.width_sd_m = std::sqrt(variance_of(widths_m));
}

}  // namespace

const char* class_name(const ObservedObject& seen) {
  if (seen.is_trunk) return "trunk";
  return seen.is_doubtful ? "doubtful" : "other";
}

TrunkModel estimate_trunk_model(const std::vector<TrunkObservation>& observations,
                                const TrunkModelOptions& options) {
  TrunkModel model;
  model.is_picked = !options.picked_trunks.empty();
  model.width_spread = options.width_spread;
  model.has_hue = std::any_of(
      observations.begin(), observations.end(),
      [](const TrunkObservation& observation) { return observation.hues.num_coloured > 0; });
  std::vector<ObjectTrack> tracks = track_objects(observations, options);
  find_neighbours(tracks, options);
  const std::vector<std::size_t> trunks = find_trunks(tracks, model.has_hue, options);
  for (const std::size_t i : trunks) tracks[i].seen.is_trunk = true;

  std::vector<std::size_t> used;
  std::vector<int> trunk_of(observations.size());
  for (const ObjectTrack& track : tracks) {
    model.objects.push_back(track.seen);
    if (!track.seen.is_trunk) continue;
    ++model.num_trunks;
    used.insert(used.end(), track.seen.observations.begin(), track.seen.observations.end());
    for (const std::size_t i : track.seen.observations) trunk_of[i] = model.num_trunks;
  }
  const std::vector<double> all_m = widths_without_spot(observations, options, model);
  measure_width(all_m, used, model);
  model.num_observations = static_cast<int>(used.size());
  std::vector<WidthObservation> widths;
  for (const std::size_t i : used) {
    widths.push_back(
        {observations[i].range_m, observations[i].beam_step_rad, all_m[i], trunk_of[i]});
  }
  model.width_by_range = width_by_range(std::move(widths));
  if (model.has_hue) {
    vision::HueHistogram hues;
    for (const std::size_t i : used) add(observations[i].hues, hues);
    const HueInterval interval = hue_interval(hues, options.hue_tail, options.hue_margin_deg);
    model.hue_min_deg = interval.min_deg;
    model.hue_max_deg = interval.max_deg;
    if (interval.width_deg > 90.0) {
      model.warnings.push_back(
          fmt::format("the hues of the trunks spread over {:.0f} degrees, so colour will hardly "
                      "help to classify",
                      std::floor(interval.width_deg)));
    }
  }
  compare_populations(tracks, trunks, model.has_hue, options, model);
  warn_of_two_populations(tracks, trunks, options, model);
  if (model.num_trunks < options.wanted_trunks) {
    model.warnings.push_back(
        fmt::format("only {} trunks were found; {} or more are needed for a reliable model",
                    model.num_trunks, options.wanted_trunks));
  }
  return model;
}

}  // namespace orchard::calibration
