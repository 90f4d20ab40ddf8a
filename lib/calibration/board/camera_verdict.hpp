// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibration/board/camera_calibration.hpp"

namespace orchard::calibration {

/// When a camera calibration is good enough to be used.
struct CameraVerdictRules {
  int fewest_views = 10;        ///< used ones
  double most_outliers = 0.25;  ///< of all views, left out as outliers
  int grid_columns = 5;         ///< parts of the picture in which corners are counted
  int grid_rows = 5;
  double least_coverage = 0.7;         ///< of the parts that must hold a corner; all four of the
                                       ///< picture's corners must, whatever the fraction
  double least_tilt_rad = 0.30;        ///< a view that counts as tilted
  int fewest_tilted = 4;               ///< such views
  double least_lean_spread = 0.10;     ///< of the tilts to the sides: the standard deviation of the
                                       ///< board's normal, across its narrower direction
  double least_distance_ratio = 1.25;  ///< of the farthest view to the nearest
  double largest_rms_px = 1.0;         ///< at 640 pixels of width; grows in proportion, not below
  double largest_fc_sd = 0.01;  ///< standard deviation of a focal length, as a fraction of it
  double largest_cc_sd = 0.01;  ///< of the principal point, as a fraction of the picture's width
  double largest_cc_offset = 0.25;     ///< of the principal point from the picture's middle, as a
                                       ///< fraction of width and height
  double largest_fc_difference = 0.1;  ///< between the two focal lengths, as a fraction
};

/// In which parts of the picture corners were found.
struct CameraCoverage {
  int columns = 0;
  int rows = 0;
  std::vector<int> corners;  ///< row by row

  double fraction() const;  ///< of the parts with a corner
};
CameraCoverage coverage_of(const CameraCalibration& calibration, int columns, int rows);

/// Why a calibration should not be used, each a sentence that says what to do; empty when it is
/// good.
std::vector<std::string> verdict_on(const CameraCalibration& calibration,
                                    const CameraVerdictRules& rules = {});

}  // namespace orchard::calibration
