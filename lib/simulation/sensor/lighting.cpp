// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/sensor/lighting.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"

namespace orchard::simulation {
namespace {

constexpr std::array<double, 3> kWavelengths_m{450e-9, 540e-9, 610e-9};

double black_body(double wavelength_m, double temperature_k) {
  constexpr double kSecondRadiation_mK = 0.014387769;  // h c / k
  return 1.0 / (std::pow(wavelength_m, 5) *
                (std::exp(kSecondRadiation_mK / (wavelength_m * temperature_k)) - 1.0));
}

double drift(double per_min, double amplitude, double period_s, double time_s) {
  return per_min * time_s / 60.0 + amplitude * std::sin(2.0 * geometry::kPi * time_s / period_s);
}

Bgr to_bgr(const std::array<double, 3>& gains) {
  return {static_cast<float>(gains[0]), static_cast<float>(gains[1]), static_cast<float>(gains[2])};
}

/// Response of a first-order control with a time constant to the light, at `time_s`.
double lagged_ev(const LightConfig& light, double lag_s, double time_s) {
  if (lag_s <= 0.0 || time_s <= 0.0) return light_ev(light, time_s);
  // The last twenty time constants contain all but 2e-9 of the response.
  constexpr int kSteps = 400;
  const double step_s = 20.0 * lag_s / kSteps;
  double sum = 0.0, weights = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double ago_s = (i + 0.5) * step_s;
    const double weight = std::exp(-ago_s / lag_s);
    sum += weight * light_ev(light, std::max(0.0, time_s - ago_s));
    weights += weight;
  }
  return sum / weights;
}

}  // namespace

std::array<double, 3> light_gains(double temperature_k, double white_balance_k) {
  std::array<double, 3> gains{};
  for (std::size_t i = 0; i < 3; ++i) {
    gains[i] = black_body(kWavelengths_m[i], temperature_k) /
               black_body(kWavelengths_m[i], white_balance_k);
  }
  const double green = gains[1];
  for (double& gain : gains) gain /= green;
  return gains;
}

double light_ev(const LightConfig& light, double time_s) {
  return drift(light.drift_ev_per_min, light.drift_ev_amplitude, light.drift_period_s, time_s);
}

double light_temperature_k(const LightConfig& light, double time_s) {
  const double k =
      light.temperature_k + drift(0.0, light.drift_k_amplitude, light.drift_period_s, time_s);
  return std::clamp(k, 1500.0, 15000.0);
}

float linear_of(float stored) {
  static const std::array<float, 257> table = [] {
    std::array<float, 257> t{};
    for (std::size_t i = 0; i < t.size(); ++i) {
      t[i] = static_cast<float>(255.0 * std::pow(static_cast<double>(i) / 255.0, 2.2));
    }
    return t;
  }();
  const float clamped = std::clamp(stored, 0.0f, 255.0f);
  const auto i = static_cast<std::size_t>(clamped);
  const float fraction = clamped - static_cast<float>(i);
  return table[i] + fraction * (table[i + 1] - table[i]);
}

Lighting::Lighting(const LightConfig& light, const CameraResponseConfig& response, double time_s)
    : sun_fraction_(static_cast<float>(light.sun_fraction)),
      vignetting_(static_cast<float>(response.vignetting)) {
  const double followed_ev = lagged_ev(light, response.auto_exposure_lag_s, time_s);
  const double ev =
      response.exposure_ev + light_ev(light, time_s) - response.auto_exposure * followed_ev;
  const double balance_k = response.white_balance_k;
  const double temperature_k = light_temperature_k(light, time_s);
  gain_ = static_cast<float>(std::exp2(ev));
  sun_ = to_bgr(light_gains(temperature_k, balance_k));
  sky_ = to_bgr(light_gains(temperature_k * light.shade_temperature_ratio, balance_k));
  for (std::size_t i = 0; i < curve_.size(); ++i) {
    const double root = static_cast<double>(i) / static_cast<double>(curve_.size() - 1);
    curve_[i] = static_cast<float>(255.0 * std::pow(root, 2.0 / response.gamma));
  }
}

float Lighting::store(float light) const {
  const float x = std::clamp(light / 255.0f, 0.0f, 1.0f);
  // Index by the square root: finer steps at the dark end, where the curve is steep.
  const float place = std::sqrt(x) * static_cast<float>(curve_.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(place), curve_.size() - 2);
  const float fraction = place - static_cast<float>(i);
  return curve_[i] + fraction * (curve_[i + 1] - curve_[i]);
}

Bgr Lighting::store(const Bgr& light, float corner) const {
  const float gain = gain_ * (1.0f - vignetting_ * corner);
  return {store(light.b * gain), store(light.g * gain), store(light.r * gain)};
}

}  // namespace orchard::simulation
