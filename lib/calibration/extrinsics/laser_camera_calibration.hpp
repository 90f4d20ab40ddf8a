// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibration/board/board_association.hpp"
#include "calibration/extrinsics/adjustment.hpp"
#include "calibration/extrinsics/stationary_views.hpp"
#include "geometry/camera_model.hpp"
#include "laser/laser_config.hpp"

namespace orchard::calibration {

/// Options of the laser-camera calibration and requirements for its acceptance.
struct LaserCameraOptions {
  int min_views = 6;                   ///< min number of views with the board in image and scan
  double min_fitting_fraction = 0.5;   ///< min inlier fraction of the views with a line of its size
  double shift_sd_max_m = 0.020;       ///< max standard deviation of the translation, any direction
  double turn_sd_max_rad = 0.0175;     ///< max standard deviation of the rotation; 1 degree
  double disagreement_max = 5.5;       ///< max disagreement of an inlier view [sigmas]
  double outlier_fraction_max = 0.34;  ///< max fraction of outlier views
  double board_scale_max = 0.02;       ///< max relative error of the board's stated size
  bool use_edges = false;              ///< constrain line ends to the outline, if it was measured
  RangeNoise noise;
};

/// The default options with the range noise of a rig's laser.
LaserCameraOptions laser_camera_options(const laser::LaserConfig& laser);

/// Limits for lines on a board of this outline, measured by a rig's laser.
BoardLineSearch line_search(const BoardOutline& outline, const laser::LaserConfig& laser);

/// Result for one view.
struct LaserCameraView {
  enum class ViewStatus { kUsed, kNoLine, kNotSeen, kOutlier };
  ViewStatus status = ViewStatus::kNoLine;
  int line = -1;  ///< index into ExtrinsicsView::lines
  double rms_m = 0.0;
  double mean_m = 0.0;  ///< mean signed distance of its points, positive beyond the board
  double disagreement = 0.0;
};

/// Laser-camera extrinsics with covariance, or the reason why they are rejected.
struct LaserCameraCalibration {
  std::string refusal;  ///< reason as one sentence; empty = the result may be used
  /// True over stated size of a board whose size was stated wrongly, by the ranges; 0 otherwise.
  double board_scale = 0.0;
  double board_scale_sd = 0.0;
  RigidExtrinsics mount;
  geometry::LaserCameraExtrinsics extrinsics;  ///< the same in the form of eqs. 1 and 2
  /// Covariance of (delta_m, rotation about the camera's axes [rad]).
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  double interval95_factor = 1.96;  ///< half width of a 95 % interval in standard deviations
  double rms_m = 0.0;               ///< RMS distance of the used views' points from their boards
  int num_used = 0;
  std::vector<LaserCameraView> views;  ///< in the order given
};

/// Estimates the laser-camera extrinsics from views of a board in both sensors, without an initial
/// guess.
///
/// `outline` is the board's outer size in its own frame; lines outside it are not the board.
/// Reasons for rejection: too few views, a board that only one sensor saw, degenerate motion, a
/// result that is too uncertain. Deterministic.
/// Source: Kassir and Peynot, ACRA 2010; Zhang and Pless, IROS 2004.
LaserCameraCalibration calibrate_laser_camera(const std::vector<ExtrinsicsView>& views,
                                              const BoardOutline& outline,
                                              const LaserCameraOptions& options);

/// Explains why estimated extrinsics contradict those stated in the rig's YAML; empty when they
/// agree within 45 degrees.
///
/// A scanner sees one plane, so a mirrored image cannot be distinguished from a camera mounted the
/// other way round: both give a proper rotation that explains every point. Only the stated
/// extrinsics can decide: an image mirrored left to right looks like a camera upside down, one
/// mirrored top to bottom like a laser on the other side of the camera.
std::string extrinsics_contradiction(const RigidExtrinsics& found, const RigidExtrinsics& stated);

}  // namespace orchard::calibration
