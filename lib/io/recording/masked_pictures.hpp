// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibration/trunks/mask_windows.hpp"
#include "vision/pixel_block.hpp"

namespace orchard::io {

/// A picture and the mask of the same name.
struct MaskedPicturePaths {
  std::string name;  ///< without folder and ending
  std::string picture;
  std::string mask;
};

/// What two folders hold of pictures with masks.
struct MaskedPictureList {
  std::vector<MaskedPicturePaths> pictures;  ///< in order of name
  std::vector<std::string> without_mask;     ///< names
};

/// A picture with the pixels of it that are trunk.
struct MaskedPicture {
  vision::PixelBlock pixels;
  calibration::TrunkMask mask;
};

/// The pictures (.jpg, .jpeg, .png) of a folder whose masks (.png, .jpg, .jpeg) another one holds
/// under the same name. `only` chooses by number: "000-019", "7", "0-19,30-39"; empty = all.
///
/// Throws FileError when a folder cannot be read, `only` is no such text, or nothing is left.
MaskedPictureList list_masked_pictures(const std::string& picture_folder,
                                       const std::string& mask_folder, const std::string& only);

/// Reads both files. Red pixels of the mask - red at least 64 and twice green and blue - are trunk.
/// Throws FileError when one is no picture, their sizes differ or nothing is red.
MaskedPicture read_masked_picture(const MaskedPicturePaths& paths);

}  // namespace orchard::io
