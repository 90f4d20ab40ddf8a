// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <vector>

#include "calibration/board/board.hpp"
#include "geometry/camera_model.hpp"

namespace orchard::calibration {

/// A board found in one picture.
struct NamedView {
  std::string name;  ///< of the picture, for people
  BoardView view;
};

/// How a camera is calibrated.
struct CameraCalibrationOptions {
  /// Estimate the sixth power of the distortion too: for wide lenses. Small pictures do not carry
  /// it, and it makes the rest worse then.
  bool estimate_k3 = false;
  /// A view is left out when its error is beyond this many times the median view's ...
  double outlier_factor = 3.0;
  /// ... and this much [px].
  double outlier_floor_px = 0.3;
};

/// What became of one view.
struct ViewFigures {
  std::string name;
  int num_corners = 0;
  double rms_px = 0.0;           ///< distance of its corners from where the model has them
  double tilt_rad = 0.0;         ///< of the board's normal against the camera's axis
  std::array<double, 2> lean{};  ///< the normal's x and y in the camera frame: to which side
  double distance_m = 0.0;       ///< from the camera to the middle of the corners seen
  bool used = true;              ///< false: an outlier, left out
};

/// A corner and how far the model misses it.
struct CornerResidual {
  ImagePoint found_px;
  double dx_px = 0.0;  ///< found minus modelled
  double dy_px = 0.0;
};

/// A camera's intrinsics as measured, and all that is needed to judge them.
struct CameraCalibration {
  geometry::CameraIntrinsics intrinsics;  ///< alpha_c is 0
  std::array<double, 2> fc_sd_px{};       ///< standard deviations
  std::array<double, 2> cc_sd_px{};
  std::array<double, 5> kc_sd{};
  double rms_px = 0.0;                    ///< root mean square distance over all used corners
  int num_views = 0;                      ///< used
  int num_corners = 0;                    ///< used
  std::vector<ViewFigures> views;         ///< all, in the order given
  std::vector<CornerResidual> residuals;  ///< of the used views
};

/// Least number of views from which anything can be computed.
inline constexpr std::size_t kFewestViews = 3;

/// Intrinsics from views of one board: Zhang's method by OpenCV, views that disagree with the rest
/// left out and named. Does not judge: see verdict_on().
///
/// The standard deviations are OpenCV's, corrected: OpenCV 4.6 divides the sum of squares by the
/// number of corners where each gives two residuals. Throws std::runtime_error with one sentence
/// when there are fewer than kFewestViews or they determine nothing.
CameraCalibration calibrate_camera(const std::vector<NamedView>& views, int width_px, int height_px,
                                   const CameraCalibrationOptions& options = {});

}  // namespace orchard::calibration
