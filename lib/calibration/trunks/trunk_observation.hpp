// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "detection/rig.hpp"
#include "laser/scan.hpp"
#include "vision/appearance/appearance_features.hpp"
#include "vision/appearance/light.hpp"
#include "vision/colour.hpp"
#include "vision/image.hpp"

namespace orchard::calibration {

/// What a window of the picture shows, for either colour model.
struct WindowObservation {
  vision::AppearanceFeatures features{};
  vision::HueHistogram hues;
};

/// One observation of something that stands alone: no model of trunks has judged it yet.
struct TrunkObservation {
  int log = 0;             ///< which of several logs it is from
  std::int64_t utime = 0;  ///< of the scan [us]
  double x_m = 0.0;        ///< of its centre, in map when in_map, else in base
  double y_m = 0.0;
  bool in_map = false;
  double range_m = 0.0;
  double beam_step_rad = 0.0;
  double width_m = 0.0;       ///< as the rig's width mode measures it
  vision::HueHistogram hues;  ///< of its colour window; num_pixels is 0 without a camera
  std::optional<vision::WindowLight> light;  ///< of its colour window
  std::vector<WindowObservation> on;         ///< between its edges, at every kLearntExposures_ev
  std::vector<WindowObservation> beside;     ///< at the same height, off everything the laser sees
  vision::PixelBlock crop;                   ///< it and what is around it; empty unless asked for
};

/// What to gather of a scan.
struct ObserveOptions {
  int min_beams = 4;   ///< narrower things tell nothing of a trunk's width
  bool crops = false;  ///< keep pixels for a person to look at
};

/// Everything of a scan that can teach a trunk model: not hidden, of at least `min_beams`, and in
/// full view of the camera when the rig has one. In base (in_map false). `image` may be null.
std::vector<TrunkObservation> observe_trunks(const laser::Scan& scan, const vision::Image* image,
                                             const detection::Rig& rig,
                                             const ObserveOptions& options);

}  // namespace orchard::calibration
