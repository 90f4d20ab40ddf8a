// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "detection/rig.hpp"
#include "laser/scan.hpp"
#include "vision/colour.hpp"
#include "vision/image.hpp"

namespace orchard::calibration {

/// One look at something that stands alone: no model of trunks has judged it yet.
struct TrunkObservation {
  int log = 0;             ///< which of several logs it is from
  std::int64_t utime = 0;  ///< of the scan [us]
  double x_m = 0.0;        ///< of its centre, in map when in_map, else in base
  double y_m = 0.0;
  bool in_map = false;
  double width_m = 0.0;       ///< as the rig's width mode measures it
  vision::HueHistogram hues;  ///< of its colour window; num_pixels is 0 without a camera
};

/// Everything of a scan that can teach a trunk model: not hidden, of at least `min_beams`, and in
/// full view of the camera when the rig has one. In base (in_map false). `image` may be null.
std::vector<TrunkObservation> observe_trunks(const laser::Scan& scan, const vision::Image* image,
                                             const detection::Rig& rig, int min_beams);

}  // namespace orchard::calibration
