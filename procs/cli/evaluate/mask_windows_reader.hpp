// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calibration/trunks/mask_windows.hpp"
#include "io/recording/picture_file.hpp"

namespace orchard::cli {

/// The pictures with masks to take windows from.
struct MaskedPictureOptions {
  std::string picture_folder;
  std::string mask_folder;
  std::string only;  ///< "000-019"; empty = all
  calibration::MaskWindowOptions windows;
};

/// A picture with its windows.
struct PictureWindows {
  std::string name;
  io::MaskedPicture picture;
  /// Pictures with equal numbers of trunk pixels in their masks show the same tree: crops or
  /// copies.
  int group = 0;
  std::vector<calibration::LabelledWindow> windows;
};

/// Numbers of pictures used and skipped.
struct PictureCount {
  int used = 0;
  int num_groups = 0;
  std::vector<std::string> left_out;  ///< skipped pictures, one sentence each
};

/// Calls `visit` with each picture and its windows, in order of name. Skips a picture with a
/// warning if it has no mask, cannot be read or has no windows; throws io::FileError when none is
/// left. The positions of a picture's windows depend only on its name and the seed.
PictureCount for_each_masked_picture(const MaskedPictureOptions& options, const char* command,
                                     bool quiet,
                                     const std::function<void(const PictureWindows&)>& visit);

}  // namespace orchard::cli
