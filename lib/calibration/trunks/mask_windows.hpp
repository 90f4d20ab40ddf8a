// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "vision/pixel_block.hpp"

namespace orchard::calibration {

/// Which pixels of a picture are trunk: 1, others 0; rows top-down, no padding.
struct TrunkMask {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint8_t> trunk;  ///< width_px x height_px

  std::int64_t num_trunk_px() const;
};

/// How windows are laid on and beside the trunks of a mask.
struct MaskWindowOptions {
  int per_class = 60;        ///< windows on trunks, and as many elsewhere, of one picture
  double aspect_min = 1.0;   ///< height over width, of the flattest windows
  double aspect_max = 3.0;   ///< and of the tallest
  double width_scale = 1.0;  ///< of the trunk's own width in the row
  double scatter = 0.15;     ///< windows are off by up to this fraction of their width, either way
  int min_width_px = 6;      ///< narrower parts of a trunk are left out
  std::uint64_t seed = 1;    ///< where they lie follows from it
};

/// A window and what it lies on.
struct LabelledWindow {
  vision::PixelRect window;
  bool is_trunk = false;
};

/// Windows on the widest trunk of random rows, each followed by one elsewhere at the same height
/// and of the same size, with no trunk pixel in it. Fewer where there is no room for them.
/// The same mask and options give the same windows.
std::vector<LabelledWindow> sample_windows(const TrunkMask& mask, const MaskWindowOptions& options);

}  // namespace orchard::calibration
