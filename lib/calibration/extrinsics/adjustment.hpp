// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibration/board/board_association.hpp"

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
  int num_edges = 0;
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

}  // namespace orchard::calibration
