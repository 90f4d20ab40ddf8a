// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibration/board/board_association.hpp"

namespace orchard::calibration {

/// One view with its board line chosen.
struct AdjustmentView {
  BoardPose board;
  BoardLine line;
  int num_scans = 1;
};

/// How well the scanner measures: where the weights begin. The adjustment finds the size of the
/// first two from the residuals; of the last it cannot.
struct RangeNoise {
  double beam_sd_m = 0.010;  ///< of each beam by itself
  double beam_sd_fraction = 0.01;
  double scan_sd_fraction = 0.01;    ///< of all beams of a board in one scan together
  double scale_sd_fraction = 0.002;  ///< of all ranges to the board for good
};

/// A mount by least squares, with what is known of its error.
struct MountAdjustment {
  Mount mount;
  /// Of (delta_m, turn about the camera's axes [rad]): the true rotation is exp(turn) R.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  double rms_m = 0.0;  ///< of the laser's points about the boards
  int num_points = 0;
  int num_edges = 0;
  double beam_factor = 1.0;      ///< the beams' noise, found against stated
  double scan_factor = 1.0;      ///< the same of whole scans
  double scan_redundancy = 0.0;  ///< degrees of freedom behind scan_factor
  double scale = 0.0;            ///< fraction by which all ranges to the board are too long
  double scale_sd = 0.0;
  struct View {
    double rms_m = 0.0;         ///< of its points about its board
    double mean_m = 0.0;        ///< their mean, positive beyond the board
    double disagreement = 0.0;  ///< in sigmas: what it took to make its board and scan agree
  };
  std::vector<View> views;
};

/// The most likely mount given the lines, the boards' poses with their covariances, and the
/// scanner's noise; Huber's loss on every beam. With `outline` the ends of lines that were seen
/// lie on the board's edges. Each view's board pose and common range error are unknowns with their
/// priors, so that the covariance holds all of them; the noise of beams and of scans is found by
/// Foerstner's variance components. None when the equations cannot be solved.
std::optional<MountAdjustment> adjust_mount(const std::vector<AdjustmentView>& views,
                                            const Mount& start, const RangeNoise& noise,
                                            const BoardOutline* outline);

}  // namespace orchard::calibration
