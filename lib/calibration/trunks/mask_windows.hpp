// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "vision/pixel_block.hpp"

namespace orchard::calibration {

/// Mask of an image: 1 for pixels on a trunk, otherwise 0; rows top-down, no padding.
struct TrunkMask {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint8_t> trunk;  ///< width_px x height_px

  std::int64_t num_trunk_px() const;
};

/// Parameters for sampling windows on and beside the trunks of a mask.
struct MaskWindowOptions {
  int per_class = 60;        ///< windows per image on trunks, and the same number elsewhere
  double aspect_min = 1.0;   ///< min ratio of height to width
  double aspect_max = 3.0;   ///< max ratio of height to width
  double width_scale = 1.0;  ///< window width relative to the trunk's width in the row
  double scatter = 0.15;     ///< max error of position and width, relative to the trunk's width
  int min_width_px = 6;      ///< narrower parts of a trunk are left out
  std::uint64_t seed = 1;    ///< of the random positions
};

/// A window and its class.
struct LabelledWindow {
  vision::PixelRect window;
  bool is_trunk = false;
};

/// Samples windows on the widest trunk of random rows, each followed by a window of the same size
/// at the same height without any trunk pixel. Fewer windows if there is not enough room.
/// Deterministic.
std::vector<LabelledWindow> sample_windows(const TrunkMask& mask, const MaskWindowOptions& options);

}  // namespace orchard::calibration
