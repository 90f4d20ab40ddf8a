// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calibration/trunks/mask_windows.hpp"
#include "vision/image.hpp"
#include "vision/pixel_block.hpp"

namespace orchard::io {

/// Which pixels a PNG is decoded to; as they are, one of more than 8 bits is refused.
enum class PngColours { kGrey, kBgr, kAsTheyAre };

/// Decodes a PNG of at most 8192 pixels per side, which its header tells before anything is
/// decoded, to GRAY8 or BGR8; utime and seq are left 0. None for anything else, or when it is
/// damaged.
std::optional<vision::Image> png_image(const std::uint8_t* data, std::size_t size,
                                       PngColours colours);

/// Reads a JPEG file without decoding it, or a PNG file decoded to GRAY8; utime and seq are left 0.
/// Throws FileError when it cannot be read, is over 16 MB, is of another format, or is larger than
/// 8192 pixels per side.
vision::Image read_picture_file(const std::string& path);

/// Whether the extension is one that read_picture_file() supports.
bool has_picture_name(const std::string& path);

/// Paths of an image and of the mask with the same name.
struct MaskedPicturePaths {
  std::string name;  ///< without folder and extension
  std::string picture;
  std::string mask;
};

/// Images of a folder with and without masks.
struct MaskedPictureList {
  std::vector<MaskedPicturePaths> pictures;  ///< in order of name
  std::vector<std::string> without_mask;     ///< names of images without a mask
};

/// An image and its trunk mask.
struct MaskedPicture {
  vision::PixelBlock pixels;
  calibration::TrunkMask mask;
};

/// Lists the images (.jpg, .jpeg, .png) of a folder that have a mask (.png, .jpg, .jpeg) of the
/// same name in the other folder. `only` selects by number: "000-019", "7", "0-19,30-39"; empty:
/// all.
///
/// Throws FileError when a folder cannot be read, `only` is malformed, or no image is left.
MaskedPictureList list_masked_pictures(const std::string& picture_folder,
                                       const std::string& mask_folder, const std::string& only);

/// Reads an image and its mask. Red pixels of the mask (red at least 64 and twice green and blue)
/// are trunk. Throws FileError when a file is not an image, the sizes differ or no pixel is red.
MaskedPicture read_masked_picture(const MaskedPicturePaths& paths);

}  // namespace orchard::io
