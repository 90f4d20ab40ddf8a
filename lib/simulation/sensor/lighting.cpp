// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/sensor/lighting.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "geometry/pose2.hpp"
#include "simulation/texture.hpp"

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

constexpr double kCell_m = 0.04;
constexpr double kBeside_m = 6.0;         ///< margin of the grid around all objects
constexpr double kThinnest_m = 0.012;     ///< thinner objects are below the resolution of a cell
constexpr double kLongest_cotangent = 6;  ///< limit of the sun's elevation, about ten degrees

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

ShadowMap::ShadowMap(const World& world, double sun_azimuth_rad, double sun_elevation_rad)
    : towards_x_(std::cos(sun_azimuth_rad)),
      towards_y_(std::sin(sun_azimuth_rad)),
      cotangent_(std::min(kLongest_cotangent, 1.0 / std::tan(sun_elevation_rad))),
      sine_(std::max(0.15, std::sin(sun_elevation_rad))) {
  double x_max_m = -1e9, y_max_m = -1e9;
  x_min_m_ = y_min_m_ = 1e9;
  for (const Cylinder& c : world.cylinders) {
    x_min_m_ = std::min(x_min_m_, c.x_m - kBeside_m);
    y_min_m_ = std::min(y_min_m_, c.y_m - kBeside_m);
    x_max_m = std::max(x_max_m, c.x_m + kBeside_m);
    y_max_m = std::max(y_max_m, c.y_m + kBeside_m);
  }
  constexpr double kMax_m = 400.0;
  if (x_max_m < x_min_m_ || x_max_m - x_min_m_ > kMax_m || y_max_m - y_min_m_ > kMax_m) return;
  num_x_ = static_cast<int>((x_max_m - x_min_m_) / kCell_m) + 1;
  num_y_ = static_cast<int>((y_max_m - y_min_m_) / kCell_m) + 1;
  cells_.resize(static_cast<std::size_t>(num_x_) * num_y_);
  for (const Cylinder& c : world.cylinders) add(c);
  for (const Box& b : world.boxes) add(b);
  for (const Crown& c : world.crowns) add(c);
}

ShadowMap::Cell* ShadowMap::at(double x_m, double y_m) {
  const int i = static_cast<int>(std::floor((x_m - x_min_m_) / kCell_m));
  const int j = static_cast<int>(std::floor((y_m - y_min_m_) / kCell_m));
  if (i < 0 || j < 0 || i >= num_x_ || j >= num_y_) return nullptr;
  return &cells_[static_cast<std::size_t>(j) * num_x_ + i];
}

void ShadowMap::add_line(double x_m, double y_m, double base_m, double top_m, int target) {
  const double step_m = 0.7 * kCell_m / std::max(0.1, cotangent_);
  for (double z_m = base_m; z_m <= top_m; z_m += step_m) {
    Cell* cell = at(x_m - towards_x_ * cotangent_ * z_m, y_m - towards_y_ * cotangent_ * z_m);
    if (cell == nullptr || z_m <= cell->top_m) continue;
    cell->top_m = static_cast<float>(z_m);
    cell->target = target;
  }
}

void ShadowMap::add(const Cylinder& cylinder) {
  if (cylinder.radius_m < kThinnest_m || cylinder.sway_m > 0.0) return;
  for (double across_m = -cylinder.radius_m; across_m <= cylinder.radius_m;
       across_m += std::min(0.7 * kCell_m, cylinder.radius_m)) {
    add_line(cylinder.x_m - towards_y_ * across_m, cylinder.y_m + towards_x_ * across_m,
             cylinder.base_m, cylinder.base_m + cylinder.height_m, cylinder.target);
  }
}

void ShadowMap::add(const Box& box) {
  const geometry::Pose2 T_map_box{box.x_m, box.y_m, box.yaw_rad};
  const double step_m = 0.7 * kCell_m;
  const auto line = [&](double along_m, double across_m) {
    const Eigen::Vector2d p = transform(T_map_box, {along_m, across_m});
    add_line(p.x(), p.y(), box.base_m, box.base_m + box.height_m, box.target);
  };
  for (double along_m = -0.5 * box.length_m; along_m <= 0.5 * box.length_m; along_m += step_m) {
    for (double across_m = -0.5 * box.width_m; across_m <= 0.5 * box.width_m; across_m += step_m) {
      line(along_m, across_m);
    }
  }
}

void ShadowMap::add(const Crown& crown) {
  // The shadow of a ball: an ellipse, longer away from the sun.
  const double middle_x_m = crown.x_m - towards_x_ * cotangent_ * crown.z_m;
  const double middle_y_m = crown.y_m - towards_y_ * cotangent_ * crown.z_m;
  const double long_m = crown.radius_m / sine_;
  const auto seed = crown.appearance.texture_seed;
  for (double along_m = -long_m; along_m <= long_m; along_m += 0.5 * kCell_m) {
    for (double across_m = -crown.radius_m; across_m <= crown.radius_m; across_m += 0.5 * kCell_m) {
      const double off = std::hypot(along_m / long_m, across_m / crown.radius_m);
      if (off > 1.0) continue;
      Cell* cell = at(middle_x_m + towards_x_ * along_m - towards_y_ * across_m,
                      middle_y_m + towards_y_ * along_m + towards_x_ * across_m);
      if (cell == nullptr) continue;
      // The same leaves as rendered: gaps between clumps, more of them towards the border.
      const auto a = static_cast<float>(along_m * sine_), b = static_cast<float>(across_m);
      const float leaves = 0.6f * value_noise(a * 9.0f, b * 9.0f, seed) +
                           0.4f * value_noise(a * 3.0f, b * 3.0f, seed + 1);
      const auto dense = static_cast<float>(crown.foliage * (1.3 - 0.9 * off * off));
      const float filled = std::clamp(2.5f * (leaves + 2.0f * dense - 1.0f) + 0.5f, 0.0f, 0.92f);
      cell->crown = std::min(cell->crown, 1.0f - filled);
    }
  }
}

float ShadowMap::open(float x_m, float y_m, float z_m, int target) const {
  if (cells_.empty()) return 1.0f;
  const double gx = (x_m - towards_x_ * cotangent_ * z_m - x_min_m_) / kCell_m - 0.5;
  const double gy = (y_m - towards_y_ * cotangent_ * z_m - y_min_m_) / kCell_m - 0.5;
  const int i = static_cast<int>(std::floor(gx)), j = static_cast<int>(std::floor(gy));
  if (i < 0 || j < 0 || i + 1 >= num_x_ || j + 1 >= num_y_) return 1.0f;
  const auto u = static_cast<float>(gx - i), v = static_cast<float>(gy - j);
  const auto value = [&](int di, int dj) {
    const Cell& cell = cells_[static_cast<std::size_t>(j + dj) * num_x_ + i + di];
    const bool solid = cell.top_m > z_m + 0.03f && cell.target != target;
    return solid ? 0.0f : cell.crown;
  };
  return (value(0, 0) * (1.0f - u) + value(1, 0) * u) * (1.0f - v) +
         (value(0, 1) * (1.0f - u) + value(1, 1) * u) * v;
}

}  // namespace orchard::simulation
