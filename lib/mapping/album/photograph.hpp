// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "vision/pixel_block.hpp"

namespace orchard::mapping {

/// An object in a scan that may be photographed (base frame at the scan's time).
struct Subject {
  double x_base_m = 0.0;  ///< of its axis
  double y_base_m = 0.0;
  double width_m = 0.0;
  std::int8_t occlusion = 0;  ///< bits of detection::Occlusion
};

/// The best photograph of an object in one passing.
struct Photograph {
  std::int64_t scan_utime = 0;   ///< of the scan, whose pose places the subject
  std::int64_t image_utime = 0;  ///< of the image it was cut out of
  vision::PixelRect frame;       ///< region in that image
  Subject subject;
  double quality = 0.0;
  std::vector<std::uint8_t> jpeg;
};

/// A photograph with the position of its subject, by the current poses.
struct PlacedPhotograph {
  Photograph photograph;
  double x_m = 0.0;
  double y_m = 0.0;
};

/// A landmark and its photograph.
struct AlbumEntry {
  std::int32_t landmark_id = 0;
  const Photograph* photograph = nullptr;
};

}  // namespace orchard::mapping
