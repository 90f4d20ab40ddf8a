// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibration/extrinsics/adjustment.hpp"
#include "calibration/extrinsics/mean_scan.hpp"
#include "calibration/extrinsics/observability.hpp"
#include "geometry/laser_camera.hpp"
#include "laser/laser_config.hpp"

namespace orchard::calibration {

/// When a laser-camera calibration is believed.
struct LaserCameraOptions {
  int min_views = 6;                   ///< with the board in picture and scan
  double min_fitting_fraction = 0.5;   ///< of the views in which the scanner saw a line of its size
  double shift_sd_max_m = 0.020;       ///< a mount less certain in any direction is refused
  double turn_sd_max_rad = 0.0175;     ///< 1 degree
  double disagreement_max = 5.5;       ///< sigmas from which a view is an outlier
  double outlier_fraction_max = 0.34;  ///< more of them and nothing is believed
  double board_scale_max = 0.02;       ///< a board that the ranges make this much larger is not it
  bool use_edges = false;              ///< the outline is measured: ends of lines lie on it
  RangeNoise noise;
};

/// The defaults with the noise of a rig's laser.
LaserCameraOptions laser_camera_options(const laser::LaserConfig& laser);

/// What a board of this outline looks like to a rig's laser.
BoardLineSearch line_search(const BoardOutline& outline, const laser::LaserConfig& laser);

/// What became of one view.
struct LaserCameraView {
  enum class Fate { kUsed, kNoLine, kNotSeen, kOutlier };
  Fate fate = Fate::kNoLine;
  int line = -1;  ///< index into MountView::lines
  double rms_m = 0.0;
  double mean_m = 0.0;  ///< of its points beyond the board
  double disagreement = 0.0;
};

/// Where the laser is in the camera frame, or why that cannot be said.
struct LaserCameraCalibration {
  std::string refusal;  ///< one sentence; empty: the rest may be used
  /// Of a board whose size was stated wrongly, true over stated, by the ranges; 0 = none such.
  double board_scale = 0.0;
  double board_scale_sd = 0.0;
  Mount mount;
  geometry::LaserCameraExtrinsics extrinsics;  ///< the same as eqs. 1 and 2 have it
  /// Of (delta_m, turn about the camera's axes [rad]).
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  /// Of (delta_m, phi_rad), to first order.
  Eigen::Matrix<double, 6, 6> covariance_phi = Eigen::Matrix<double, 6, 6>::Zero();
  double interval95_factor = 1.96;  ///< half a 95 % interval is this many standard deviations
  double rms_m = 0.0;               ///< of the points of all used views about their boards
  double beam_factor = 1.0;         ///< the beams' noise against options.noise, as found
  double scan_factor = 1.0;         ///< the same of whole scans
  int num_used = 0;
  BoardMotion motion;
  std::vector<LaserCameraView> views;  ///< as given
};

/// Calibrates a laser to a camera from views of a board in both, without a first guess.
///
/// The outline is the board's outer size in its own frame; lines that do not lie on it are not
/// the board. Every refusal names its reason: too few views, a board that only one sensor saw,
/// degenerate motion, an outcome that is too uncertain. The same views give the same bits.
/// Source: Kassir and Peynot, ACRA 2010; Zhang and Pless, IROS 2004.
LaserCameraCalibration calibrate_laser_camera(const std::vector<MountView>& views,
                                              const BoardOutline& outline,
                                              const LaserCameraOptions& options);

}  // namespace orchard::calibration
