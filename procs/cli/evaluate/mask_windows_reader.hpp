// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calibration/trunks/mask_windows.hpp"
#include "io/recording/masked_pictures.hpp"

namespace orchard::cli {

/// Which pictures with masks to take windows from.
struct MaskedPictureOptions {
  std::string picture_folder;
  std::string mask_folder;
  std::string only;  ///< "000-019"; empty = all
  calibration::MaskWindowOptions windows;
  bool quiet = false;  ///< no progress bar
};

/// A picture with its windows.
struct PictureWindows {
  std::string name;
  io::MaskedPicture picture;
  /// Pictures whose masks have as many trunk pixels show the same tree: crops or copies.
  int group = 0;
  std::vector<calibration::LabelledWindow> windows;
};

/// What became of the pictures.
struct PictureCount {
  int used = 0;
  int num_groups = 0;
  std::vector<std::string> left_out;  ///< one sentence each
};

/// Gives each picture with its windows to `visit`, in order of name. A picture without a mask, that
/// cannot be read or has no windows is left out with a warning; throws io::FileError when none
/// is left. Where the windows of a picture lie depends on its name and the seed only.
PictureCount for_each_masked_picture(const MaskedPictureOptions& options, const char* command,
                                     const std::function<void(const PictureWindows&)>& visit);

}  // namespace orchard::cli
