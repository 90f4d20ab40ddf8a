// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/sensor/receiver_sky.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"

namespace orchard::simulation {
namespace {

constexpr double kDay_s = 86400.0;

/// Steps of the slowly varying error per time constant; linear interpolation between them.
constexpr double kStepsPerTime = 10.0;

/// Max number of steps per day.
constexpr double kStepsMax = 1e6;

enum Part : std::uint64_t { kGaps, kPauses, kReflections, kWander };

/// Draws a duration from the exponential distribution.
double exponential(double mean, Random& random) { return -mean * std::log(1.0 - random.uniform()); }

}  // namespace

ReceiverSky::ReceiverSky(std::uint64_t seed, const SkyConfig& config) : config_(config) {
  const auto stream = [seed](Part part) { return Random(seed, Stream::kGnssSky, part); };
  if (config.gap_every_s > 0.0) {
    Random random = stream(kGaps);
    double time_s = exponential(config.gap_every_s, random);
    while (time_s < kDay_s) {
      // Uniform in the logarithm of the length.
      const double ratio = config.gap_max_s / config.gap_min_s;
      const double end_s = time_s + config.gap_min_s * std::pow(ratio, random.uniform());
      gaps_.push_back({time_s, end_s, Eigen::Vector2d::Zero()});
      time_s = end_s + exponential(config.gap_every_s, random);
    }
  }
  if (config.burst_s > 0.0 && config.pause_s > 0.0) {
    Random random = stream(kPauses);
    double time_s = exponential(config.burst_s, random);
    while (time_s < kDay_s) {
      const double end_s = time_s + exponential(config.pause_s, random);
      pauses_.push_back({time_s, end_s, Eigen::Vector2d::Zero()});
      time_s = end_s + exponential(config.burst_s, random);
    }
  }
  if (config.multipath_fraction > 0.0) {
    Random random = stream(kReflections);
    const double between_s =
        config.multipath_for_s * (1.0 - config.multipath_fraction) / config.multipath_fraction;
    double time_s = exponential(between_s, random);
    while (time_s < kDay_s) {
      const double end_s = time_s + exponential(config.multipath_for_s, random);
      const double towards_rad = random.uniform(-geometry::kPi, geometry::kPi);
      const double length_m = exponential(config.multipath_m, random);
      reflections_.push_back(
          {time_s, end_s,
           length_m * Eigen::Vector2d(std::cos(towards_rad), std::sin(towards_rad))});
      time_s = end_s + exponential(between_s, random);
    }
  }
  if (config.wander_sd_m > 0.0) {
    Random random = stream(kWander);
    const double steps = std::min(kStepsMax, kDay_s * kStepsPerTime / config.wander_time_s);
    const double memory = std::exp(-kDay_s / steps / config.wander_time_s);
    const double fresh = std::sqrt(1.0 - memory * memory);
    Eigen::Vector2d now;
    now << random.normal(), random.normal();
    for (int i = 0; i <= static_cast<int>(steps); ++i) {
      wander_.push_back(now);
      const double east = random.normal(), north = random.normal();
      now = memory * now + fresh * Eigen::Vector2d(east, north);
    }
  }
}

const ReceiverSky::Episode* ReceiverSky::at(const std::vector<Episode>& episodes, double time_s) {
  time_s = std::fmod(std::max(time_s, 0.0), kDay_s);
  const auto after =
      std::upper_bound(episodes.begin(), episodes.end(), time_s,
                       [](double time, const Episode& episode) { return time < episode.begin_s; });
  if (after == episodes.begin() || time_s >= std::prev(after)->end_s) return nullptr;
  return &*std::prev(after);
}

bool ReceiverSky::is_open(double time_s) const {
  return at(gaps_, time_s) == nullptr && at(pauses_, time_s) == nullptr;
}

bool ReceiverSky::is_reflected(double time_s) const { return at(reflections_, time_s) != nullptr; }

Eigen::Vector2d ReceiverSky::error_m(double time_s) const {
  Eigen::Vector2d error = Eigen::Vector2d::Zero();
  if (const Episode* reflection = at(reflections_, time_s)) error += reflection->offset_m;
  if (!wander_.empty()) {
    const double last = static_cast<double>(wander_.size() - 1);
    const double step = std::fmod(std::max(time_s, 0.0), kDay_s) / kDay_s * last;
    const auto before = static_cast<std::size_t>(std::min(step, last - 1.0));
    const double part = step - static_cast<double>(before);
    error += config_.wander_sd_m * ((1.0 - part) * wander_[before] + part * wander_[before + 1]);
  }
  return error;
}

}  // namespace orchard::simulation
