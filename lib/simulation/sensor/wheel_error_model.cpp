// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/sensor/wheel_error_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "simulation/random.hpp"

namespace orchard::simulation {

WheelErrorModel::WheelErrorModel(std::uint64_t seed, const WheelsConfig& config, double duration_s)
    : seed_(seed), config_(config) {
  if (config.bias_wander_sd_radps <= 0.0) return;
  // An Ornstein-Uhlenbeck process in its exact discrete form.
  Random random(seed, Stream::kWheelBias);
  const double kept = std::exp(-1.0 / config.bias_wander_s);
  const double fresh_sd = config.bias_wander_sd_radps * std::sqrt(1.0 - kept * kept);
  double bias_radps = random.normal(0.0, config.bias_wander_sd_radps);
  for (double t_s = 0.0; t_s <= duration_s + 2.0; t_s += 1.0) {
    bias_radps_.push_back(bias_radps);
    bias_radps = kept * bias_radps + random.normal(0.0, fresh_sd);
  }
}

/// Smooth noise over the ground with standard deviation 1: patches of surface_m.
double WheelErrorModel::ground(std::uint64_t layer, double x_m, double y_m) const {
  const double u = x_m / config_.surface_m, w = y_m / config_.surface_m;
  const double i = std::floor(u), j = std::floor(w);
  double sum = 0.0, weight2 = 0.0;
  for (const double di : {0.0, 1.0}) {
    for (const double dj : {0.0, 1.0}) {
      const double weight = (1.0 - std::abs(u - i - di)) * (1.0 - std::abs(w - j - dj));
      const auto cell =
          static_cast<std::uint64_t>(static_cast<std::int64_t>(i + di)) * 0x9e3779b1u ^
          static_cast<std::uint64_t>(static_cast<std::int64_t>(j + dj)) * 0x85ebca77u;
      sum += weight * Random(seed_ ^ (layer << 56), Stream::kSurface, cell).normal();
      weight2 += weight * weight;
    }
  }
  return sum / std::sqrt(weight2);
}

OdometryErrors WheelErrorModel::errors_at(const OdometryErrors& run, double time_s,
                                          const Pose2& T_map_base) const {
  OdometryErrors errors = run;
  if (config_.surface_slip_sd > 0.0) {
    errors.speed_scale += config_.surface_slip_sd * ground(0, T_map_base.x_m, T_map_base.y_m);
  }
  if (config_.surface_turn_slip_sd > 0.0) {
    errors.yaw_rate_scale +=
        config_.surface_turn_slip_sd * ground(1, T_map_base.x_m, T_map_base.y_m);
  }
  if (config_.load_sd > 0.0) {
    const auto load = static_cast<std::uint64_t>(std::max(0.0, time_s) / config_.load_every_s);
    errors.speed_scale += Random(seed_, Stream::kLoad, load).normal(0.0, config_.load_sd);
  }
  if (!bias_radps_.empty()) {
    const double last = static_cast<double>(bias_radps_.size()) - 1.0;
    const double at = std::clamp(time_s, 0.0, last - 1e-9);
    const auto i = static_cast<std::size_t>(at);
    const double fraction = at - std::floor(at);
    errors.yaw_rate_bias_radps += (1.0 - fraction) * bias_radps_[i] + fraction * bias_radps_[i + 1];
  }
  return errors;
}

}  // namespace orchard::simulation
