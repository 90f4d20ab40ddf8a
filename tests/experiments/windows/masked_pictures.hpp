// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "vision/pixel_block.hpp"

namespace orchard::evaluation {

/// A window and its class.
struct LabelledWindow {
  vision::PixelRect window;
  bool is_trunk = false;
};

/// A picture with its windows.
struct PictureWindows {
  vision::PixelBlock pixels;
  /// Pictures with equal numbers of trunk pixels in their masks show the same tree: crops or
  /// copies.
  int group = 0;
  std::vector<LabelledWindow> windows;
};

/// The pictures of a folder whose numbers are in `only` ("000-019,30"; empty: all), by name, each
/// with 60 windows on the trunk that its mask of the same name marks in red, and 60 beside it. The
/// positions of a picture's windows depend on its name only. Throws io::FileError for a picture
/// without mask, or one that cannot be read.
std::vector<PictureWindows> read_masked_pictures(const std::string& picture_folder,
                                                 const std::string& mask_folder,
                                                 const std::string& only);

}  // namespace orchard::evaluation
