// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::simulation {

/// The light in a picture. Section `simulation.light`. Disabled: simple shading.
struct LightConfig {
  bool enabled = false;
  bool sun_from_seed = true;
  double sun_azimuth_deg = 0.0;
  double sun_elevation_deg = 40.0;
  double sun_fraction = 0.75;
  bool shadows = true;
  double temperature_k = 5500.0;
  double shade_temperature_ratio = 1;
  double drift_ev_per_min = 0.0;
  double drift_ev_amplitude = 0.0;
  double drift_k_per_min = 0.0;
  double drift_k_amplitude = 0.0;
  double drift_period_s = 120.0;
};

template <class Visitor>
void describe(Visitor& v, LightConfig& c) {
  v.flag("enabled", c.enabled,
         "simulate sun, sky and shadows in linear light; needed by the keys below");
  v.flag("sun_from_seed", c.sun_from_seed, "the seed chooses the direction of the sun");
  v.number("sun_azimuth_deg", c.sun_azimuth_deg, -360, 360, "deg",
           "azimuth of the sun, from map x towards y");
  v.number("sun_elevation_deg", c.sun_elevation_deg, 3, 90, "deg",
           "elevation of the sun above the horizon");
  v.number("sun_fraction", c.sun_fraction, 0, 1, "1",
           "fraction of the light that comes directly from the sun");
  v.flag("shadows", c.shadows, "shadows of objects, dappled under crowns");
  v.number("temperature_k", c.temperature_k, 1500, 15000, "K", "colour temperature of the sun");
  v.number("shade_temperature_ratio", c.shade_temperature_ratio, 0.5, 4, "1",
           "ratio of the colour temperatures of sky and sun");
  v.number("drift_ev_amplitude", c.drift_ev_amplitude, 0, 4, "EV",
           "amplitude of a sine of that brightness");
  v.number("drift_k_amplitude", c.drift_k_amplitude, 0, 5000, "K",
           "amplitude of a sine of the colour temperature");
  v.number("drift_period_s", c.drift_period_s, 1, 1e5, "s", "period of both sines");
}

/// Response of the camera to light. Section `simulation.camera_response`; takes effect when
/// `simulation.light.enabled`.
struct CameraResponseConfig {
  double exposure_ev = 0.0;
  double white_balance_k = 5500.0;
  double auto_exposure = 0.0;
  double auto_exposure_lag_s = 0.5;
  double auto_white_balance = 0.0;  ///< compensated fraction of the colour's drift
  double vignetting = 0.0;
  double gamma = 2.2;
  double exposure_s = 0.0;
};

template <class Visitor>
void describe(Visitor& v, CameraResponseConfig& c) {
  v.number("exposure_ev", c.exposure_ev, -6, 6, "EV",
           "exposure; 0: white in full sun is full scale");
  v.number("white_balance_k", c.white_balance_k, 1500, 15000, "K",
           "colour temperature that appears neutral");
  v.number("auto_exposure", c.auto_exposure, 0, 1, "1",
           "fraction of the drift of the light that the exposure compensates");
  v.number("auto_exposure_lag_s", c.auto_exposure_lag_s, 0, 60, "s",
           "time constant of that compensation");
  v.number("vignetting", c.vignetting, 0, 1, "1", "fraction of light lost in the corners");
  v.number("exposure_s", c.exposure_s, 0, 0.1, "s",
           "exposure time, for motion blur while turning; 0 = sharp");
}

}  // namespace orchard::simulation
