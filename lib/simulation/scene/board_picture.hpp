// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "calibration/board/board_pattern.hpp"
#include "calibration/board/grey_picture.hpp"
#include "geometry/camera_model.hpp"
#include "simulation/random.hpp"

namespace orchard::simulation {

/// How a board is lit and photographed. Grey levels are 0 to 255.
struct BoardPictureConfig {
  double white = 205.0;      ///< of the paper in full light
  double black = 35.0;       ///< of the ink
  double shading = 0.25;     ///< largest change of light from one side of the picture to another
  double clutter = 55.0;     ///< contrast of what stands behind
  double blur_px = 0.6;      ///< standard deviation of the lens' blur
  double noise_sd = 2.0;     ///< of each pixel, grey levels
  int samples_per_side = 4;  ///< rays through a pixel: this number squared
};

/// Takes pictures of a board through a lens with its distortion: rays through every part of a pixel
/// to the board's plane, so that corners lie where the camera model says to a few hundredths of a
/// pixel.
class BoardPainter {
 public:
  BoardPainter(const geometry::CameraIntrinsics& camera, const calibration::BoardConfig& board,
               const BoardPictureConfig& config = {});

  /// What the camera sees of a board at T_camera_board (its back away from the camera), or of the
  /// clutter alone. The board's back is blank.
  calibration::GreyPicture take(const std::optional<Eigen::Isometry3d>& T_camera_board,
                                Random& random) const;

 private:
  struct Ray {
    float x = 0.0f;  ///< at z = 1 of the camera frame
    float y = 0.0f;
  };

  geometry::CameraIntrinsics camera_;
  calibration::BoardPattern pattern_;
  BoardPictureConfig config_;
  std::vector<Ray> rays_;  ///< samples_per_side^2 per pixel
};

}  // namespace orchard::simulation
