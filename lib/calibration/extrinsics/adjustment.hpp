// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calibration/board/board_association.hpp"
#include "calibration/board/board_pose.hpp"

namespace orchard::calibration {

/// One view with its associated board line.
struct AdjustmentView {
  BoardPose board;
  BoardLine line;
  int num_scans = 1;
};

/// Initial noise model of the scanner. The adjustment rescales the noise of beams and of scans from
/// the residuals, but not the scale error.
struct RangeNoise {
  double beam_sd_m = 0.010;  ///< independent noise of each beam
  double beam_sd_fraction = 0.01;
  double scan_sd_fraction = 0.01;    ///< error common to all beams on the board in one scan
  double scale_sd_fraction = 0.002;  ///< systematic scale error of all ranges to the board
};

/// Extrinsics estimated by least squares, with covariance and residuals.
struct ExtrinsicsAdjustment {
  RigidExtrinsics mount;
  /// Covariance of (delta_m, rotation about the camera's axes [rad]): the true rotation is
  /// exp(rotation) R.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  double rms_m = 0.0;  ///< RMS distance of the laser's points from the boards
  int num_points = 0;
  double beam_factor = 1.0;      ///< ratio of estimated to stated noise of the beams
  double scan_factor = 1.0;      ///< the same ratio for whole scans
  double scan_redundancy = 0.0;  ///< degrees of freedom of scan_factor
  double scale = 0.0;            ///< fraction by which all ranges to the board are too long
  double scale_sd = 0.0;
  struct View {
    double rms_m = 0.0;         ///< RMS distance of its points from its board
    double mean_m = 0.0;        ///< mean signed distance, positive beyond the board
    double disagreement = 0.0;  ///< correction [sigmas] that makes board and scan agree
  };
  std::vector<View> views;
};

/// Estimates the extrinsics by maximum likelihood from the lines, the board poses with their
/// covariances, and the range noise, with a Huber loss on every beam. With `outline`, visible line
/// ends are constrained to the board's edges. The board pose and the common range error of each
/// view are unknowns with priors, so the covariance includes their uncertainty. Foerstner's
/// variance components give the noise of beams and of scans. None when the equations cannot be
/// solved.
std::optional<ExtrinsicsAdjustment> adjust_extrinsics(const std::vector<AdjustmentView>& views,
                                                      const RigidExtrinsics& start,
                                                      const RangeNoise& noise,
                                                      const BoardOutline* outline);

/// Variety of the board poses, as needed for the observability of the laser-camera extrinsics.
struct BoardMotion {
  /// Standard deviations of the normals about their best plane and about their common direction
  /// [rad]: out_of_plane is 0 when all normals lie in one plane, out_of_line when all are parallel.
  double out_of_plane = 0.0;
  double out_of_line = 0.0;
  Eigen::Vector3d axis_camera = Eigen::Vector3d::UnitY();  ///< axis normal to that best plane
  double tilt_max_deg = 0.0;                               ///< largest angle between two boards
  double distance_min_m = 0.0;                             ///< distances of the board planes
  double distance_max_m = 0.0;
  double moved_m = 0.0;      ///< largest distance between two board origins
  int num_orientations = 0;  ///< number that differ by more than their noise and 6 degrees
};

BoardMotion board_motion(const std::vector<BoardPose>& boards);

/// Explains why a set of board poses does not determine the extrinsics, with the remedy; empty when
/// it does.
///
/// A line in a board's plane constrains the translation only along the board's normal, so the
/// normals must span space. If all normals lie in one plane, the translation normal to that plane
/// is undetermined (for an upright board also two rotations); if all are parallel, two directions
/// are. Needs no scan.
std::string degenerate_motion(const BoardMotion& motion);

/// Names the weakest direction if the covariance (as in ExtrinsicsAdjustment) exceeds the limits;
/// empty when every standard deviation is within them.
std::string undetermined_direction(const Eigen::Matrix<double, 6, 6>& covariance,
                                   double shift_sd_max_m, double turn_sd_max_rad,
                                   const BoardMotion& motion);

}  // namespace orchard::calibration
