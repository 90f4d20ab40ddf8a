// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "calibration/board/board.hpp"
#include "geometry/camera_model.hpp"

namespace orchard::calibration {

/// A board found in one image.
struct NamedView {
  std::string name;  ///< name of the image for messages
  BoardView view;
};

/// Options of the camera calibration.
struct CameraCalibrationOptions {
  /// Whether to estimate k3 (radial distortion of sixth order), for wide lenses. Small images do
  /// not determine it, and it then degrades the other parameters.
  bool estimate_k3 = false;
  /// A view is an outlier if its error exceeds this multiple of the median view's error ...
  double outlier_factor = 3.0;
  /// ... and also this limit [px].
  double outlier_floor_px = 0.3;
};

/// Result for one view.
struct ViewFigures {
  std::string name;
  int num_corners = 0;
  double rms_px = 0.0;           ///< RMS distance of its corners from the model's
  double tilt_rad = 0.0;         ///< angle between the board's normal and the optical axis
  std::array<double, 2> lean{};  ///< x and y of the normal in the camera frame: direction of tilt
  double distance_m = 0.0;       ///< from the camera to the middle of the visible corners
  bool used = true;              ///< false: left out as an outlier
};

/// Estimated intrinsics and the figures for judging them.
struct CameraCalibration {
  geometry::CameraIntrinsics intrinsics;  ///< alpha_c is 0
  std::array<double, 2> fc_sd_px{};       ///< standard deviations
  std::array<double, 2> cc_sd_px{};
  std::array<double, 5> kc_sd{};
  double rms_px = 0.0;                      ///< root mean square distance over all used corners
  int num_views = 0;                        ///< used
  int num_corners = 0;                      ///< used
  std::vector<ViewFigures> views;           ///< all, in the order given
  std::vector<Eigen::Vector2d> corners_px;  ///< found, of the used views
};

// derived: Zhang's method has five unknowns, two equations for each view.
/// Min number of views for a calibration.
inline constexpr std::size_t kMinViews = 3;

/// Estimates the intrinsics from views of one board by Zhang's method (OpenCV). Outlier views are
/// left out and marked. The result is not judged here; see rejection_reasons().
///
/// The standard deviations are OpenCV's, corrected: OpenCV 4.6 divides the sum of squares by the
/// number of corners, although each gives two residuals. Throws std::runtime_error with one
/// sentence for fewer than kMinViews or degenerate views.
CameraCalibration calibrate_camera(const std::vector<NamedView>& views, int width_px, int height_px,
                                   const CameraCalibrationOptions& options = {});

/// Selects at most `count` views that differ most in position, size and tilt, because a recording
/// contains hundreds of similar ones. Returns indices in ascending order.
std::vector<std::size_t> select_spread(const std::vector<NamedView>& views, int width_px,
                                       int height_px, std::size_t count);

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
