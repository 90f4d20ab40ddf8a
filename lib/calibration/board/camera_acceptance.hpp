// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibration/board/camera_calibration.hpp"

namespace orchard::calibration {

/// Requirements for a usable camera calibration.
struct CameraAcceptanceLimits {
  int min_views = 10;                  ///< min number of used views
  double max_outlier_fraction = 0.25;  ///< max fraction of outliers among all views
  int grid_columns = 5;                ///< grid of image cells in which corners are counted
  int grid_rows = 5;
  /// Min fraction of the cells with a corner; the cells at the image's corners always need one.
  double min_coverage = 0.7;
  double min_tilt_rad = 0.30;  ///< min tilt of a view that counts as tilted
  int min_tilted = 4;          ///< min number of tilted views
  /// Min spread of the tilt directions: standard deviation of the board's normal in its narrower
  /// direction.
  double min_lean_spread = 0.10;
  double min_distance_ratio = 1.25;  ///< min ratio of the farthest to the nearest view
  double max_rms_px = 1.0;  ///< for images up to 640 px wide; proportional to larger widths
  double max_fc_sd = 0.01;  ///< max standard deviation of a focal length, relative to it
  double max_cc_sd = 0.01;  ///< max standard deviation of the principal point over image width
  /// Max offset of the principal point from the image's middle, relative to width and height.
  double max_cc_offset = 0.25;
  double max_fc_difference = 0.1;  ///< max relative difference of the two focal lengths
};

/// Number of corners found in each cell of a grid over the image.
struct CameraCoverage {
  int columns = 0;
  int rows = 0;
  std::vector<int> corners;  ///< per cell, row by row

  double fraction() const;  ///< fraction of the cells with a corner
};
CameraCoverage coverage_of(const CameraCalibration& calibration, int columns, int rows);

/// The reasons why a calibration should not be used, each a sentence with the remedy; empty when it
/// is good.
std::vector<std::string> rejection_reasons(const CameraCalibration& calibration,
                                           const CameraAcceptanceLimits& rules = {});

}  // namespace orchard::calibration
