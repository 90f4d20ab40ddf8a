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

/// Light and camera properties of a picture of a board. Grey levels are 0 to 255.
struct BoardPictureConfig {
  double white = 205.0;      ///< of the paper in full light
  double black = 35.0;       ///< of the ink
  double shading = 0.25;     ///< largest change of light from one side of the picture to another
  double clutter = 55.0;     ///< contrast of the background
  double blur_px = 0.6;      ///< standard deviation of the lens' blur
  double noise_sd = 2.0;     ///< of each pixel, grey levels
  int samples_per_side = 4;  ///< rays through a pixel: this number squared
};

/// Renders pictures of a board through a distorting lens. Rays through every part of a pixel meet
/// the board's plane, so the corners agree with the camera model to a few hundredths of a pixel.
class BoardPainter {
 public:
  BoardPainter(const geometry::CameraIntrinsics& camera, const calibration::BoardConfig& board,
               const BoardPictureConfig& config = {});

  /// Renders a board at T_camera_board (its back away from the camera), or the background alone.
  /// The board's back is blank.
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
