// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "simulation/sensor/light_config.hpp"
#include "simulation/sensor/texture.hpp"

namespace orchard::simulation {

/// Blue, green and red of a black body relative to those of another, green 1: how a camera whose
/// white balance is set for `white_balance_k` shows light of `temperature_k`. Planck's law at 450,
/// 540 and 610 nm, about where the Bayer filters of small sensors pass most.
std::array<double, 3> light_gains(double temperature_k, double white_balance_k);

/// The light of a run relative to its beginning [EV], and its colour temperature [K].
double light_ev(const LightConfig& light, double time_s);
double light_temperature_k(const LightConfig& light, double time_s);

/// Linear light from a stored value (0 to 255 both), at the usual gamma of 2.2.
float linear_of(float stored);
inline Bgr linear_of(const Bgr& c) { return {linear_of(c.b), linear_of(c.g), linear_of(c.r)}; }

/// Sun, sky and camera at one moment of a run: turns the linear light of a surface, as it would
/// be under white light, into what the sensor collects.
class Lighting {
 public:
  Lighting(const LightConfig& light, const CameraResponseConfig& response, double time_s);

  /// Linear light that a surface sends: `facing` is the cosine between its normal and the sun (0
  /// when turned away), `open` the fraction of the sun that reaches it, `sky` the fraction of the
  /// sky that it sees.
  Bgr shade(const Bgr& albedo, float facing, float open, float sky) const {
    const float direct = sun_fraction_ * facing * open, around = (1.0f - sun_fraction_) * sky;
    return {albedo.b * (direct * sun_.b + around * sky_.b),
            albedo.g * (direct * sun_.g + around * sky_.g),
            albedo.r * (direct * sun_.r + around * sky_.r)};
  }
  /// What shines by itself: the sky and what is far away.
  Bgr emit(const Bgr& c) const { return {c.b * sky_.b, c.g * sky_.g, c.r * sky_.r}; }

  /// The stored value, 0 to 255, of linear light at a place of the picture; clips.
  /// `corner` is the squared distance from the middle, 1 in the corners.
  Bgr store(const Bgr& light, float corner) const;

  double exposure_gain() const { return gain_; }

 private:
  float store(float light) const;

  float sun_fraction_;
  Bgr sun_, sky_;  ///< gains
  float gain_ = 1.0f;
  float vignetting_;
  std::array<float, 4097> curve_{};
};

}  // namespace orchard::simulation
