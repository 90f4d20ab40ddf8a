// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "detection/rig.hpp"
#include "laser/scan.hpp"
#include "vision/appearance.hpp"
#include "vision/appearance_config.hpp"
#include "vision/colour.hpp"
#include "vision/image.hpp"

namespace orchard::calibration {

/// Features of an image window for both colour models.
struct WindowObservation {
  vision::AppearanceFeatures features{};
  vision::HueHistogram hues;
};

/// One observation of a free-standing object, not yet classified by any trunk model.
struct TrunkObservation {
  int log = 0;             ///< index of the log
  std::int64_t utime = 0;  ///< of the scan [us]
  double x_m = 0.0;        ///< of its centre; in map if in_map, otherwise in base
  double y_m = 0.0;
  bool in_map = false;
  double range_m = 0.0;
  double beam_step_rad = 0.0;
  double width_m = 0.0;       ///< according to the rig's width mode
  vision::HueHistogram hues;  ///< of its colour window; num_pixels is 0 without a camera
  std::optional<vision::WindowLight> light;  ///< of its colour window
  std::vector<WindowObservation> on;         ///< between its edges, at every kLearntExposures_ev
  std::vector<WindowObservation> beside;     ///< at the same height, beside all objects of the scan
};

/// Extracts from a scan all objects that are usable for a trunk model: not hidden, at least
/// `min_beams` (fewer do not determine a width), and fully in view of the camera if the rig has
/// one. Positions are in base (in_map false). `image` may be null.
std::vector<TrunkObservation> observe_trunks(const laser::Scan& scan, const vision::Image* image,
                                             const detection::Rig& rig, int min_beams);

}  // namespace orchard::calibration
